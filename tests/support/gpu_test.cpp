#include "support/gpu_test.h"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "files/project_folder.h"

namespace lab {

const Device& test_device() {
    static const Device device({.choice = "", .validation = true});
    return device;
}

uint32_t test_seed(uint32_t seed) {
    const char* text = std::getenv("LAB_TEST_SEED");
    return seed + (text ? 1000003 * static_cast<uint32_t>(std::strtoul(text, nullptr, 10)) : 0);
}

std::string instance_name(const std::string& name, Run run) { return name + (run == Run::with_all ? "_all" : ""); }

void run_shader(const TestShader& shader, size_t invocations, std::span<std::byte> results, std::span<const std::byte> inputs,
                const Device& device) {
    Buffer result_buffer(device, results.size(), vk::BufferUsageFlagBits::eStorageBuffer);
    const Buffer input_buffer(device, inputs, vk::BufferUsageFlagBits::eStorageBuffer);
    const std::vector<Binding> bindings{storage_binding(0, result_buffer), storage_binding(1, input_buffer)};
    const ShaderSource source{.file = project_folder() / "tests" / "shaders" / shader.name,
                              .defines = shader.defines,
                              .named_includes = shader.named_includes};
    const ComputeKernel kernel(device, source, bindings, 0);
    constexpr size_t group_size = 128;
    device.submit([&](const vk::raii::CommandBuffer& commands) {
        kernel.record(commands, nullptr, static_cast<uint32_t>((invocations + group_size - 1) / group_size));
    });
    result_buffer.read(results.data(), results.size());
}

void record(const char* name, const char* format, ...) {
    char text[200];
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    testing::Test::RecordProperty(name, text);
}

}  // namespace lab
