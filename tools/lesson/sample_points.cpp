// Writes points of a sampler of a chapter as 32-bit floats to the standard output, for ./lab sample:
// sample_points SAMPLER CHAPTER COUNT SAMPLES_OF_A_PIXEL SEED DIMENSIONS DEVICE
#include <iostream>
#include <map>

#include "app/all_backends.h"
#include "error.h"
#include "files/project_folder.h"
#include "gpu/compute_kernel.h"
#include "platform.h"
#include "rendering/renderer.h"
#include "rendering/settings.h"
#include "shaders/interface.h"

namespace {

using namespace lab;

struct Sampler {
    std::string define;  // of sample_points.comp
    uint32_t columns;    // numbers of a point; 0: DIMENSIONS
};
const std::map<std::string, Sampler> samplers{{"numbers", {"NUMBERS", 0}},           {"sobol", {"SOBOL", 2}},
                                              {"blog-hash", {"BLOG_HASH", 2}},       {"directions", {"DIRECTIONS", 4}},
                                              {"light points", {"LIGHT_POINTS", 2}}, {"lens points", {"LENS_POINTS", 2}}};

// As in sample_points.comp.
struct Inputs {
    uvec2 key;
    uint32_t max_path_length, samples;
    LightTriangle light_triangle;
};

// `count` points: `samples` of each pixel, pixel after pixel.
std::vector<float> sample(const std::string& define, const std::string& chapter, uint32_t columns, uint32_t count,
                          uint32_t samples, uint32_t seed, const std::string& device_name) {
    const ShaderSource source{.file = project_folder() / "tools/lesson/sample_points.comp",
                              .defines = {define, "COLUMNS " + std::to_string(columns)},
                              .named_includes = named_includes(estimator_of(load_chapter(chapter)))};
    const Device device({.choice = device_name});
    // A table of one triangle, the stub's second one, that always stands for itself.
    const Inputs inputs{seed_key(seed), 1, samples, {0, 1, 0xffffffffu, 0, 1.0f}};
    std::vector<float> points(size_t{count} * columns);
    Buffer results(device, points.size() * sizeof(float), vk::BufferUsageFlagBits::eStorageBuffer);
    const Buffer input_buffer(device, std::span(&inputs, 1), vk::BufferUsageFlagBits::eStorageBuffer);
    const std::vector<Binding> bindings{storage_binding(0, results), storage_binding(1, input_buffer)};
    const ComputeKernel kernel(device, source, bindings, 0);
    device.submit([&](const auto& commands) { kernel.record(commands, nullptr, (count + 127) / 128); });
    results.read(points.data(), points.size() * sizeof(float));
    return points;
}

}  // namespace

int main(int argument_count, char** arguments) {
    const std::vector<std::string> words(arguments + 1, arguments + argument_count);
    const auto number = [&](size_t i) { return static_cast<uint32_t>(std::stoul(words[i])); };
    try {
        if (words.size() != 7 || !samplers.contains(words[0]))
            throw std::runtime_error("sample_points is a part of ./lab sample: call that");
        const Sampler& sampler = samplers.at(words[0]);
        const auto points = sample(sampler.define, words[1], sampler.columns > 0 ? sampler.columns : number(5), number(2),
                                   number(3), number(4), words[6]);
        make_binary(stdout);
        std::cout.write(reinterpret_cast<const char*>(points.data()),
                        static_cast<std::streamsize>(points.size() * sizeof(float)));
        return std::cout ? 0 : 1;
    } catch (const DeviceError& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 1;
    }
}
