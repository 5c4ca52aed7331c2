// What does not fit into memory is refused with its size, before any time or memory is spent on it.
#include <functional>

#include "error.h"
#include "rendering/film.h"
#include "rendering/render_job.h"
#include "rendering/renderer.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"
#include "tracing/gpu_bvh.h"

namespace lab {
namespace {

constexpr uint32_t mebibyte = 1 << 20;

// The message of the device's refusal.
std::string refusal(const std::function<void()>& allocate) {
    try {
        allocate();
    } catch (const DeviceFailure& failure) {
        return failure.what();
    }
    return "";
}

std::string in_mebibytes(size_t bytes) { return std::to_string((bytes + mebibyte - 1) / mebibyte) + " MiB"; }

TEST(Memory, RefusesBuffersThatTheDeviceDoesNotAllow) {
    const auto& limits = test_device().limits();
    const auto usage = vk::BufferUsageFlagBits::eStorageBuffer;
    const size_t limit = limits.maxStorageBufferRange;
    const MemoryNeed fits{"positions", limit, usage}, too_large{"positions", limit + 1, usage};
    if (limit < size_t{1} << 30) {
        EXPECT_EQ(refusal([&] { require_memory(test_device(), {&fits, 1}); }), "");
    }
    const std::string text = refusal([&] { require_memory(test_device(), {&too_large, 1}); });
    EXPECT_NE(text.find("positions, a buffer of " + in_mebibytes(limit + 1)), std::string::npos) << text;
    EXPECT_NE(text.find(in_mebibytes(limit)), std::string::npos) << text;
}

// Each part would fit alone, but not all of them.
TEST(Memory, RefusesMoreThanTheDeviceHas) {
    const size_t memory = test_device().description().memory;
    std::vector<MemoryNeed> parts(8, {"textures", memory / 8});
    EXPECT_EQ(refusal([&] { require_memory(test_device(), parts); }), "");
    parts.push_back({"light probe", 8 * mebibyte});
    const std::string text = refusal([&] { require_memory(test_device(), parts); });
    EXPECT_NE(text.find("textures of " + in_mebibytes(memory / 8)), std::string::npos) << text;
    EXPECT_NE(text.find("has " + in_mebibytes(memory)), std::string::npos) << text;
}

TEST(Memory, OfFilmsIsWhatTheyAllocate) {
    const MemoryNeed need = Film::memory_need(48, 40);
    EXPECT_EQ(need.bytes, 48u * 40u * sizeof(FilmPixel));
    const std::string text = refusal([] { Film(test_device(), 65535, 65535); });
    EXPECT_NE(text.find(in_mebibytes(size_t{65535} * 65535 * sizeof(FilmPixel))), std::string::npos) << text;
}

// A binding of 128 MiB, the limit of some devices, holds 4.2 million pixels.
TEST(Memory, HoldsFilmsOfSixteenMegapixels) {
    for (const auto& size : {uvec2(4096, 4096), uvec2(7680, 2160)})
        EXPECT_EQ(refusal([&] { require_memory(test_device(), Renderer::memory_needs(size)); }), "");
    const size_t largest = Film::max_pixels(test_device().description());
    const MemoryNeed fits = Film::memory_need(static_cast<uint32_t>(largest / 8), 8),
                     too_large = Film::memory_need(static_cast<uint32_t>(largest / 8 + 1), 8);
    EXPECT_EQ(refusal([&] { require_memory(test_device(), {&fits, 1}); }), "");
    EXPECT_NE(refusal([&] { require_memory(test_device(), {&too_large, 1}); }), "");
}

// Light paths reach any pixel, so what they add must be bound as a whole.
TEST(Memory, OfLightPathsLimitsTheFilm) {
    const auto needs = [](uint32_t rows) { return Renderer::memory_needs({4096, rows}, 1); };
    EXPECT_EQ(needs(64).back().bytes, 4096u * 64u * SPLAT_WORDS * sizeof(uint32_t));
    const size_t most = largest_visible(test_device(), vk::BufferUsageFlagBits::eStorageBuffer) / needs(1).back().bytes;
    const std::string text = refusal([&] { require_memory(test_device(), needs(static_cast<uint32_t>(most + 1))); });
    EXPECT_NE(text.find("pixels of light paths"), std::string::npos) << text;
}

TEST(Memory, OfSmallRendersIsThatOfFilmAndSamples) {
    const auto needs = Renderer::memory_needs({48, 40});
    ASSERT_EQ(needs.size(), 2u);
    EXPECT_EQ(needs[0].bytes, Film::memory_need(48, 40).bytes);
    // Enough to keep a large device busy with a small image, and within every device's limits.
    EXPECT_GE(needs[1].bytes, (size_t{1} << 20) * sizeof(vec3));
    EXPECT_LT(needs[1].bytes, size_t{128} * mebibyte);
    EXPECT_EQ(refusal([&] { require_memory(test_device(), needs); }), "");
}

// A tree over that many instances would take minutes to build, and much of the host's memory.
TEST(Memory, RefusesTheTreeBeforeItIsBuilt) {
    Scene scene = lit_scene(bumpy_sphere(100));
    const size_t bytes = std::max(largest_visible(test_device(), vk::BufferUsageFlagBits::eUniformTexelBuffer),
                                  largest_visible(test_device(), vk::BufferUsageFlagBits::eStorageBuffer));
    const size_t fitting = bytes / sizeof(BvhTriangle) / scene.triangles.size();
    if (fitting * scene.triangles.size() > max_triangle_count) GTEST_SKIP() << "the device holds any tree";
    for (size_t i = 0; i <= fitting; ++i) place(scene, mat4x3(1));
    const GpuScene gpu_scene(test_device(), scene);
    const std::string text = refusal([&] { compute_backend->build(test_device(), gpu_scene); });
    // Once the tree is built, buffers are refused without their own name.
    EXPECT_NE(text.find("triangles of all instances, a buffer of "), std::string::npos) << text;
}

}  // namespace
}  // namespace lab
