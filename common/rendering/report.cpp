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
    const auto set = [&](const char* name, double ErrorMetrics::*metric) {
        result[name] = row.error ? json((*row.error).*metric) : json();
    };
    set("mse", &ErrorMetrics::mse);
    set("rel_mse", &ErrorMetrics::rel_mse);
    set("rel_rmse", &ErrorMetrics::rel_rmse);
    set("mse_uncorrected", &ErrorMetrics::mse_uncorrected);
    set("rel_mse_uncorrected", &ErrorMetrics::rel_mse_uncorrected);
    result["mean"] = row.mean;
    return result;
}

std::string to_csv(const json& rows) {
    std::ostringstream names, values;
    for (const auto& row : rows) {
        names.str("");  // the same for every row
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
        values << "\n";
    }
    return rows.empty() ? "" : names.str() + "\n" + values.str();
}

}  // namespace

void write_report(const std::filesystem::path& file, const FilmImage& image, const FilmRecord& record,
                  const AccelerationStructure& acceleration_structure, ErrorSource source,
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
                {"acceleration_structure_bytes", acceleration_structure.bytes()},
                {"acceleration_structure_seconds", acceleration_structure.build_seconds()},
                {"invalid_samples", image.invalid_samples()},
                {"error_source", source == ErrorSource::reference ? "reference" : "halves"},
                {"rows", json::array()}};
    for (const auto& row : rows) report["rows"].push_back(to_json(row));
    const bool is_csv = lower_case_extension(file) == ".csv";
    // The name of a scene may be any bytes; JSON is UTF-8.
    const std::string text =
        is_csv ? to_csv(report["rows"]) : report.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
    write_file(file, text);
}

}  // namespace lab
