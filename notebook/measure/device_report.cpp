// ./lab notebook device_report: how accurate this device's arithmetic is, compared with Vulkan's guarantees. The tests derive
// their tolerances from the same measurement.
#include <cstdio>

#include "files/file.h"
#include "measure/measurement.h"
#include "support/device_arithmetic.h"

namespace lab {
namespace {

json report_functions(const Device& device) {
    json rows = json::array();
    std::printf("\n%-22s %-48s %10s %10s   %s\n", "function", "arguments", "absolute", "ulp", "Vulkan guarantees");
    for (const FunctionError& error : measure_functions(device)) {
        const bool is_broken = error.share_of_guarantee > 1;
        char absolute[16] = "";
        if (error.absolute) std::snprintf(absolute, sizeof absolute, "%.2g", *error.absolute);
        std::printf("%-22s %-48s %10s %10.4g   %s%s\n", error.name.c_str(), error.range.c_str(), absolute, error.ulps,
                    error.guaranteed.c_str(), is_broken ? "  BROKEN" : "");
        rows.push_back({{"function", error.name},
                        {"arguments", error.range},
                        {"absolute", error.absolute ? json(*error.absolute) : json()},
                        {"ulp", error.ulps},
                        {"guaranteed", error.guaranteed},
                        {"share_of_guarantee", error.share_of_guarantee}});
    }
    for (const auto& row : rows)
        if (row["share_of_guarantee"] > 1)
            std::printf("%s is outside Vulkan's guarantee on this device: %.3g times what is allowed\n",
                        row["function"].get<std::string>().c_str(), row["share_of_guarantee"].get<double>());
    return rows;
}

json report_samplers(const Device& device) {
    json rows = json::array();
    std::printf("\n%-34s %10s\n", "sampler", "absolute");
    for (const SamplerError& error : measure_samplers(device)) {
        std::printf("%-34s %10.2g\n", error.name.c_str(), error.absolute);
        rows.push_back({{"sampler", error.name}, {"absolute", error.absolute}});
    }
    return rows;
}

json report_hit_points(const Device& device) {
    json rows = json::array();
    std::printf("\n%-12s %-44s %20s %20s\n", "hit points", "scene", "off plane / offset", "off ray / length");
    for (const HitPointError& error : measure_hit_points(device)) {
        const std::string backend = to_string(error.backend);
        std::printf("%-12s %-44s %20.2g %20.2g\n", backend.c_str(), error.scene.c_str(), error.off_plane, error.off_ray);
        rows.push_back(
            {{"backend", backend}, {"scene", error.scene}, {"off_plane", error.off_plane}, {"off_ray", error.off_ray}});
    }
    return rows;
}

int run(const std::string& choice, const std::filesystem::path& output) {
    const Device device({.choice = choice});
    const auto& description = device.description();
    std::printf("%s, %s: largest errors against double\n", description.name.c_str(), description.driver.c_str());
    json record = record_of(device);
    record["functions"] = report_functions(device);
    record["samplers"] = report_samplers(device);
    record["hit_points"] = report_hit_points(device);
    if (!output.empty()) write_file(output, record.dump(2) + "\n");
    return 0;
}

}  // namespace
}  // namespace lab

int main(int argument_count, char** arguments) {
    CLI::App app("Measures how exact a device's arithmetic is", "device_report");
    std::string device;
    std::filesystem::path output;
    app.add_option("--device", device, "Number or part of the name of a device");
    app.add_option("--output", output, "JSON file to write");
    return lab::run_measurement(app, argument_count, arguments, [&] { return lab::run(device, output); });
}
