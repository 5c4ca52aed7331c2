// For tests that use a device: the device with validation layers, and test shaders that fill an array.
#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "app/all_backends.h"
#include "gpu/compute_kernel.h"

namespace lab {

// The device of this process, created on the first call, with validation layers enabled. test_main.cpp fails every test during
// which they complain.
const Device& test_device();

// The seed to use for this one in this run: LAB_TEST_SEED gives all tests other random numbers.
uint32_t test_seed(uint32_t seed);

// A test whose name, or whose instance's name, ends in _all runs only with ./lab test --all: see tests/CMakeLists.txt.
enum class Run { always, with_all };
std::string instance_name(const std::string& name, Run run);

// A shader that computes one result per invocation.
struct TestShader {
    std::string name;  // file name in tests/shaders
    std::vector<std::string> defines = {};
    std::map<std::string, std::filesystem::path> named_includes = {};
};

// Runs at least `invocations` invocations in groups of 128. `results` (binding 0) and `inputs` (binding 1) are storage buffers;
// invocations beyond the results must return at once.
void run_shader(const TestShader& shader, size_t invocations, std::span<std::byte> results, std::span<const std::byte> inputs,
                const Device& device = test_device());

// One result per input. The shader declares, in scalar layout, arrays `results` and `inputs` of matching types.
template <typename Result, typename Input>
std::vector<Result> run_shader(const TestShader& shader, const std::vector<Input>& inputs, const Device& device = test_device()) {
    std::vector<Result> results(inputs.size());
    run_shader(shader, inputs.size(), std::as_writable_bytes(std::span(results)), std::as_bytes(std::span(inputs)), device);
    return results;
}

// Adds a measured number to the test's report, for docs/numerics.md. The name is in snake_case; the value is formatted as by
// printf, with its unit.
__attribute__((format(printf, 2, 3))) void record(const char* name, const char* format, ...);

}  // namespace lab
