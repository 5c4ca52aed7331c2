#include "rendering/outputs.h"

#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "error.h"
#include "files/file.h"
#include "gpu/device.h"
#include "parallel.h"

namespace lab {

void write_picture(const std::filesystem::path& file, const FilmImage& film, const FilmHeader& header, const Options& options) {
    const std::string ending = lower_case_extension(file);
    if (ending == ".exr")
        write_film(file, film, header);
    else if (ending == ".hdr")
        write_hdr(file, film.mean());
    else if (ending == ".png")
        write_png(file, to_display(film, options.image.display(), options.appearance.exposure));
    else
        write_jpg(file, to_display(film, options.image.display(), options.appearance.exposure));
}

// Keeps the last snapshot, and returns what was kept.
static std::string keep(const FilmImage& film, const std::function<void()>& write) {
    if (!film.exceeds(0)) return ": there was nothing to write yet";
    try {
        write();
    } catch (const UserError& unwritten) {
        return std::string("; ") + unwritten.what();
    }
    return ": the outputs hold " + std::to_string(film.min_samples()) + " samples a pixel; --resume continues";
}

void write_after_failure(const std::exception& error, const FilmImage& film, const std::function<void()>& write) {
    const Failure failure = failure_of(error);
    if (failure.exit_code != 3) throw;
    const std::string message = failure.message + keep(film, write);
    if (!dynamic_cast<const EndlessWork*>(&error)) throw DeviceFailure(message);
    std::fflush(stdout);
    std::fprintf(stderr, "error: %s\n", message.c_str());
    std::_Exit(failure.exit_code);  // without destroying what the shader uses
}

void write_each(const std::vector<std::filesystem::path>& files, const std::function<void(const std::filesystem::path&)>& write) {
    std::vector<std::optional<UserError>> failures(files.size());
    in_parallel(files.size(), 1, [&](size_t i, size_t) {
        try {
            write(files[i]);
        } catch (const UserError& error) {
            failures[i] = error;
        }
    });
    for (const auto& failure : failures)
        if (failure) throw *failure;
}

namespace {

using json = nlohmann::ordered_json;

// A row with the same fields in JSON and CSV; unknown errors become null.
json to_json(const ReportRow& row) {
    json result{{"samples", row.samples},
                {"seconds", row.seconds},
                {"device_seconds", row.device_seconds},
                {"cpu_seconds", row.cpu_seconds},
                {"rays", row.rays}};
    const auto set = [&](const char* name, double ErrorMetrics::*metric) {
        result[name] = row.error ? json((*row.error).*metric) : json();
    };
    set("mse", &ErrorMetrics::mse);
    set("rel_mse", &ErrorMetrics::rel_mse);
    set("rel_rmse", &ErrorMetrics::rel_rmse);
    set("mse_uncorrected", &ErrorMetrics::mse_uncorrected);
    set("rel_mse_uncorrected", &ErrorMetrics::rel_mse_uncorrected);
    if (row.filter_error) {
        result["variance"] = row.filter_error->variance;
        result["squared_bias"] = row.filter_error->squared_bias();
        result["rel_mse_unfiltered"] = row.filter_error->unfiltered;
    }
    result["mean"] = row.mean;
    result["difference"] = row.difference;
    return result;
}

std::string to_csv(const json& rows) {
    std::ostringstream names, values;
    for (const auto& row : rows) {
        names.str("");  // the same for every row
        for (const auto& [name, value] : row.items()) {
            const char* separator = names.tellp() > 0 ? "," : "";
            if (value.is_array()) {
                names << separator << name << "_r," << name << "_g," << name << "_b";
                values << separator << value[0] << ',' << value[1] << ',' << value[2];
            } else {
                names << separator << name;
                values << separator;
                if (!value.is_null()) values << value;
            }
        }
        values << "\n";
    }
    return rows.empty() ? "" : names.str() + "\n" + values.str();
}

}  // namespace

void write_report(const std::filesystem::path& file, const FilmImage& image, const FilmHeader& header,
                  const SceneBackend& scene_backend, ErrorSource source, const std::vector<ReportRow>& rows) {
    json report{{"chapter", header.chapter},
                {"scene", header.scene},
                {"scene_hash", header.scene_hash},
                {"settings", header.settings},
                {"width", image.width},
                {"height", image.height},
                {"backend", header.backend},
                {"device", header.device},
                {"seed", header.seed},
                {"first_sample", header.first_sample},
                {"acceleration_structure_bytes", scene_backend.bytes()},
                {"acceleration_structure_seconds", scene_backend.build_seconds()},
                {"invalid_samples", image.invalid_samples()},
                {"error_source", source == ErrorSource::reference ? "reference" : "halves"},
                {"rows", json::array()}};
    for (const auto& row : rows) report["rows"].push_back(to_json(row));
    const bool is_csv = lower_case_extension(file) == ".csv";
    // Scene names may contain any bytes, but JSON is UTF-8.
    const std::string text = is_csv ? to_csv(report["rows"]) : report.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
    write_file(file, text);
}

}  // namespace lab
