// Shared by the programs in this folder.
#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "app/all_backends.h"
#include "gpu/device.h"

namespace lab {

using json = nlohmann::ordered_json;

// Describes the device; every record starts with this.
json record_of(const Device& device);

// What all programs that write a record of a device's speed ask for.
struct RecordSettings {
    std::string device = {};
    uint32_t size;  // width and height of the image
    std::filesystem::path output;
};

void add_record_options(CLI::App& app, RecordSettings& settings);

// Reads the command line and measures. Returns the program's exit code.
int run_measurement(CLI::App& app, int argument_count, char** arguments, const std::function<int()>& measure);

}  // namespace lab
