#include "measure/measurement.h"

#include <cstdio>

namespace lab {

json record_of(const Device& device) {
    const auto& description = device.description();
    return {{"device", description.name}, {"driver", description.driver}, {"api_version", description.api_version}};
}

void add_record_options(CLI::App& app, RecordSettings& settings) {
    app.add_option("--device", settings.device, "Number or part of the name of a device");
    app.add_option("--size", settings.size, "Width and height of the image")->check(CLI::Range(8, 4096))->capture_default_str();
    app.add_option("--output", settings.output, "JSON file to write")->capture_default_str();
}

int run_measurement(CLI::App& app, int argument_count, char** arguments, const std::function<int()>& measure) {
    CLI11_PARSE(app, argument_count, arguments);
    try {
        return measure();
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}

}  // namespace lab
