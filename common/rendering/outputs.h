// The files that a render leaves behind.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "film/film_file.h"
#include "rendering/options.h"
#include "statistics/error_metrics.h"
#include "tracing/tracer.h"

namespace lab {

// Writes the film in the format that the file's ending asks for. PNG and JPG show it as --view and --exposure
// say.
void write_picture(const std::filesystem::path& file, const FilmImage& film, const FilmRecord& record,
                   const Options& options);

// After a failure of the device or of memory: writes the film that was last read, and throws DeviceFailure
// with what has happened first and what is left. Other errors are thrown again.
[[noreturn]] void keep_after(const std::exception& error, const FilmImage& film,
                             const std::function<void()>& write);

// Writes all files, also those after one that cannot be written; then throws the first UserError, if any.
void write_each(const std::vector<std::filesystem::path>& files,
                const std::function<void(const std::filesystem::path&)>& write);

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
