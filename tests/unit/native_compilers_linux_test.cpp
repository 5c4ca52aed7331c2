// What other versions of glslang write for a shader means the same to the backend native.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <span>

#include "files/file.h"
#include "files/project_folder.h"
#include "gpu/shader_compiler.h"
#include "native/module.h"

namespace lab {
namespace {

std::filesystem::path folder() { return project_folder() / "tests/unit/compilers"; }

std::vector<float> run(const native::Code& code) {
    std::vector<float> results(16 * 128);
    std::vector<uint32_t> block(13 + 2 * 32);
    for (uint32_t i = 0; i < 12; ++i) block[1 + i] = std::bit_cast<uint32_t>(0.3f * static_cast<float>(i));
    const float texels[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    native::Texture textures[] = {{texels, 2, 2, true}, {texels + 4, 2, 1, true}, {texels, 2, 2, true}};
    uint32_t first = 1;
    native::Bindings bindings{};
    const auto bind = [&](size_t index, auto numbers) {
        bindings.ranges[index] = {reinterpret_cast<std::byte*>(numbers.data()), numbers.size_bytes()};
    };
    bind(1, std::span(results));
    bind(2, std::span(block));
    bind(3, std::span(textures));
    bind(4, std::span(textures).subspan(1));
    bindings.push_constants = reinterpret_cast<std::byte*>(&first);
    native::run_groups(code.run, bindings, 1);
    return results;
}

TEST(NativeCompilers, NewerOnesGiveTheSameResults_all) {
    for (const native::Mode mode : {native::Mode::fast, native::Mode::debug}) {
        native::set_mode(mode);
        const native::Code code = native::load(compile_shader({.file = folder() / "every_function.comp"}, true));
        EXPECT_EQ(code.why_one_by_one.empty(), mode == native::Mode::fast) << code.why_one_by_one;
        const std::vector<float> expected = run(code);
        for (const char* newer : {"glslang_15.spv", "glslang_16.spv"}) {
            const std::string bytes = read_file(folder() / newer, UINT64_MAX);
            std::vector<uint32_t> words(bytes.size() / sizeof(uint32_t));
            std::memcpy(words.data(), bytes.data(), bytes.size());
            const std::vector<float> results = run(native::load(words));
            for (size_t i = 0; i < results.size(); ++i)
                EXPECT_EQ(std::bit_cast<uint32_t>(results[i]), std::bit_cast<uint32_t>(expected[i]))
                    << newer << ", number " << i % 128 << " of invocation " << i / 128 << ": " << results[i] << ", "
                    << expected[i];
        }
    }
    native::set_mode(native::Mode::fast);
}

}  // namespace
}  // namespace lab
