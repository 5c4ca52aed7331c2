// The report of a run: error against samples and seconds.
#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "film/film_file.h"
#include "statistics/error_metrics.h"
#include "tracing/tracer.h"

namespace lab {

struct ReportRow {
    uint32_t samples = 0;       // a pixel
    double seconds = 0;         // that a user waits for while it renders, without those of making rows
    double device_seconds = 0;  // that the device was busy in this run
    uint64_t rays = 0;
    std::array<double, 3> mean{};  // radiance of the image
    std::optional<ErrorMetrics> error;
};

// What the errors of a report are: against a reference, or estimated from two halves of the samples.
enum class ErrorSource { reference, halves };

// Writes .json or .csv, by the file's ending.
void write_report(const std::filesystem::path& file, const FilmImage& image, const FilmRecord& record,
                  const AccelerationStructure& acceleration_structure, ErrorSource source,
                  const std::vector<ReportRow>& rows);

}  // namespace lab
