#include "measure/measurement.h"

#include <cstdio>

namespace lab {

json record_of(const Device& device) {
    const auto& description = device.description();
    return {{"device", description.name}, {"driver", description.driver}, {"api_version", description.api_version}};
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
