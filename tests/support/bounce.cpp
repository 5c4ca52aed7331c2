#include "support/bounce.h"

#include <cstdio>
#include <filesystem>

#include "files/project_folder.h"
#include "rendering/renderer.h"
#include "support/render.h"

namespace lab {
namespace {

std::vector<Bounce> run_bounces(const std::string& chapter, const Surface& surface, uvec2 key,
                                const std::vector<RandomState>& seeds, size_t count, const Device& device,
                                std::vector<std::string> defines = {}) {
    struct Header {
        Surface surface;
        uint32_t max_path_length;
        uvec2 key;
    };
    const Header header{surface, 1, key};
    const auto header_bytes = std::as_bytes(std::span(&header, 1)), seed_bytes = std::as_bytes(std::span(seeds));
    std::vector<std::byte> inputs(header_bytes.begin(), header_bytes.end());
    inputs.insert(inputs.end(), seed_bytes.begin(), seed_bytes.end());
    const Estimator estimator = chapter_estimator(chapter);
    defines.insert(defines.end(), estimator.defines.begin(), estimator.defines.end());
    TestShader shader{.name = "bounce.comp", .defines = std::move(defines), .named_includes = named_includes(estimator)};
    if (surface.material.specular_albedo != vec3(0)) shader.defines.emplace_back("FEATURE_SPECULAR");
    std::vector<Bounce> bounces(count);
    run_shader(shader, count, std::as_writable_bytes(std::span(bounces)), inputs, device);
    return bounces;
}

}  // namespace

Material white_material() {
    Material material{};
    material.diffuse_albedo = vec3(1);
    material.albedo_texture = -1;
    return material;
}

std::vector<Bounce> sample_bounces(const std::string& chapter, const Surface& surface, size_t count, uint32_t run) {
    return run_bounces(chapter, surface, seed_key(test_seed(run)), {}, count, test_device());
}

std::vector<Bounce> bounces_at(const std::string& chapter, const Surface& surface,
                               const std::vector<std::array<double, 2>>& numbers, const Device& device) {
    std::vector<RandomState> seeds;
    for (const auto& u : numbers) seeds.push_back(state_before(u));
    return run_bounces(chapter, surface, {0, 0}, seeds, seeds.size(), device);
}

std::vector<Bounce> bounces_with_roulette(const std::string& chapter, float survival_probability,
                                          const std::vector<RandomState>& seeds) {
    char define[40];
    std::snprintf(define, sizeof define, "SURVIVAL_CAP %.9g", survival_probability);
    return run_bounces(chapter, {.material = white_material()}, {0, 0}, seeds, seeds.size(), test_device(), {define});
}

std::string bsdf_name(const testing::TestParamInfo<std::string>& info) {
    const bool is_own = std::filesystem::exists(project_folder() / "chapters" / info.param / "sample_bsdf.glsl");
    return instance_name(chapter_name(info), is_own ? Run::always : Run::with_all);
}

}  // namespace lab
