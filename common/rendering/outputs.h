// Files that a render writes: pictures and reports.
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

// Writes the film in the format given by the file's extension. --view and --exposure affect PNG and JPG only.
void write_picture(const std::filesystem::path& file, const FilmImage& film, const FilmHeader& header, const Options& options);

// After a failure of device or memory: calls write() to keep the last snapshot, then throws DeviceFailure with the cause and what
// was kept, or after EndlessWork ends the program. Rethrows other errors.
[[noreturn]] void write_after_failure(const std::exception& error, const FilmImage& film, const std::function<void()>& write);

// Writes all files at once, even if some fail, then throws the first UserError.
void write_each(const std::vector<std::filesystem::path>& files, const std::function<void(const std::filesystem::path&)>& write);

struct ReportRow {
    uint32_t samples = 0;       // per pixel
    double seconds = 0;         // of rendering, without computing rows
    double device_seconds = 0;  // on the device, in this run
    double cpu_seconds = 0;     // of all threads of this program in this run, without computing rows
    uint64_t rays = 0;
    std::array<double, 3> mean{};        // radiance of the image
    std::array<double, 3> difference{};  // mean of one half of the samples minus that of the other
    std::optional<ErrorMetrics> error;
    std::optional<FilterError> filter_error = {};  // of a filtered picture
};

// Errors are measured against a reference, or estimated from the halves of the samples.
enum class ErrorSource { reference, halves };

// Writes .json or .csv.
void write_report(const std::filesystem::path& file, const FilmImage& image, const FilmHeader& header,
                  const SceneBackend& scene_backend, ErrorSource source, const std::vector<ReportRow>& rows);

}  // namespace lab
