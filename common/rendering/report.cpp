#include "rendering/report.h"

#include <nlohmann/json.hpp>
#include <sstream>

#include "files/file.h"

namespace lab {
namespace {

using json = nlohmann::ordered_json;

// One row with the same fields in JSON and CSV; unknown errors are null.
json to_json(const ReportRow& row) {
    json result{{"samples", row.samples},
                {"seconds", row.seconds},
                {"device_seconds", row.device_seconds},
                {"rays", row.rays}};
    const ErrorMetrics error = row.error.value_or(ErrorMetrics{});
    const auto set = [&](const char* name, double value) {
        if (row.error)
            result[name] = value;
        else
            result[name] = nullptr;
    };
    set("mse", error.mse);
    set("rel_mse", error.rel_mse);
    set("rel_rmse", error.rel_rmse);
    set("mse_uncorrected", error.mse_uncorrected);
    set("rel_mse_uncorrected", error.rel_mse_uncorrected);
    result["mean"] = row.mean;
    return result;
}

std::string to_csv(const json& rows) {
    std::ostringstream text;
    bool first = true;
    for (const auto& row : rows) {
        std::ostringstream names, values;
        for (const auto& [name, value] : row.items()) {
            if (name == "mean") {
                names << "mean_r,mean_g,mean_b";
                values << value[0] << ',' << value[1] << ',' << value[2];
            } else {
                names << name << ',';
                if (!value.is_null()) values << value;
                values << ',';
            }
        }
        if (first) text << names.str() << "\n";
        first = false;
        text << values.str() << "\n";
    }
    return text.str();
}

}  // namespace

void write_report(const std::filesystem::path& file, const FilmImage& image, const FilmRecord& record,
                  const AccelerationRecord& acceleration, ErrorSource source,
                  const std::vector<ReportRow>& rows) {
    json report{{"chapter", record.chapter},
                {"scene", record.scene},
                {"scene_hash", record.scene_hash},
                {"settings", record.settings},
                {"width", image.width},
                {"height", image.height},
                {"backend", record.backend},
                {"device", record.device},
                {"seed", record.seed},
                {"first_sample", record.first_sample},
                {"acceleration_structure_bytes", acceleration.bytes},
                {"acceleration_structure_seconds", acceleration.build_seconds},
                {"invalid_samples", image.invalid_samples()},
                {"error_source", source == ErrorSource::reference ? "reference" : "halves"},
                {"rows", json::array()}};
    for (const auto& row : rows) report["rows"].push_back(to_json(row));
    const bool is_csv = lower_case_extension(file) == ".csv";
    const std::string text = is_csv ? to_csv(report["rows"]) : report.dump(2) + "\n";
    write_file(file, text);
}

}  // namespace lab
