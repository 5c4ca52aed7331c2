// A feature that a scene lacks costs nothing: no instruction, no binding, no byte. Each feature is enabled on its own, and code
// and buffers must contain what it needs and nothing else.
#include "rendering/renderer.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scene_features.h"
#include "support/scenes.h"
#include "support/shader_code.h"

namespace lab {
namespace {

// What a scene makes of a chapter's shaders: their code, and its buffers on the device.
struct Footprint {
    ShaderCode code;
    std::set<uint32_t> bindings;
};

// What a feature adds to the footprint of the bare scene.
struct Needs {
    std::set<uint32_t> bindings = {};
    std::set<std::string> functions = {}, material_members = {}, parameter_members = {};
    bool reads_images = false;
};

const std::map<std::string, Needs>& needs_of_features() {
    static const Needs dielectric{.functions = {"sample_dielectric", "get_fresnel_reflectance"},
                                  .material_members = {"refractive_index"}};
    static const std::map<std::string, Needs> needs{
        {"vertex normals", {.bindings = {BINDING_NORMALS}}},
        {"textures",
         {.bindings = {BINDING_TEXTURE_COORDINATES, BINDING_TEXTURES, BINDING_TEXTURE_SIZES},
          .functions = {"get_texture_colour"},
          .material_members = {"albedo_texture"},
          .reads_images = true}},
        {"sky", {.parameter_members = {"background"}}},
        {"light probe",
         {.bindings = {BINDING_LIGHT_PROBE, BINDING_PROBE_CELLS},
          .functions = {"get_light_probe_radiance", "choose_probe_cell"},
          .parameter_members = {"background", "probe_rotation"},
          .reads_images = true}},
        {"area lights",
         {.bindings = {BINDING_LIGHT_TRIANGLES}, .functions = {"choose_light_triangle"}, .material_members = {"light_density"}}},
        {"Phong lobe", {.material_members = {"specular_albedo", "specular_exponent"}}},
        {"dielectrics", dielectric},
        {"absorption", {.functions = dielectric.functions, .material_members = {"refractive_index", "absorption"}}},
        {"transforms", {.bindings = {BINDING_INSTANCES}}},
        {"microfacets", {.bindings = {BINDING_MICROFACETS}, .functions = {"get_facet_distribution", "get_fresnel_reflectance"}}},
        {"lens", {.functions = {"sample_disc"}}},
        {"media", {.bindings = {BINDING_MEDIA}, .functions = {"sample_phase"}}},
        {"densities", {.bindings = {BINDING_MEDIA, BINDING_DENSITIES}, .functions = {"sample_phase", "get_density"}}}};
    return needs;
}

// Walls without light.
Scene bare_scene() { return closed_box(diffuse_material(vec3(0.5f))); }

class FeatureCode : public testing::TestWithParam<std::string> {
  protected:
    Footprint footprint(const Scene& scene, Backend backend) const {
        const RenderSettings settings{.strategy = samples_lights(GetParam()) ? Strategy::both : Strategy::bounces,
                                      .estimator = chapter_estimator(GetParam())};
        const GpuScene gpu_scene = make_gpu_scene(scene, settings);
        const auto scene_backend = backend->build(test_device(), gpu_scene);
        std::set<std::string> functions;
        for (const auto& [name, needs] : needs_of_features()) functions.insert(needs.functions.begin(), needs.functions.end());
        functions.insert("choose_light_by_tree");
        Footprint result;
        for (const auto& binding : gpu_scene.bindings()) result.bindings.insert(binding.index);
        for (const auto& shader : scene_backend->shaders(chapter_estimator(GetParam())))
            result.code.merge(read_code(shader, functions));
        return result;
    }

    void expect_no_feature_in_bare_scene(Backend backend) const;
    void expect_each_feature_alone(Backend backend) const;
};

template <typename T>
std::set<T> joined(std::set<T> a, const std::set<T>& b) {
    a.insert(b.begin(), b.end());
    return a;
}

void FeatureCode::expect_no_feature_in_bare_scene(Backend backend) const {
    const Footprint bare = footprint(bare_scene(), backend);
    const std::set<uint32_t> arrays{BINDING_POSITIONS, BINDING_TRIANGLES, BINDING_TRIANGLE_MATERIALS, BINDING_MATERIALS};
    std::set<uint32_t> others{BINDING_RENDER_PARAMETERS, BINDING_FILM, BINDING_RAY_COUNTERS};
    if (backend == compute_backend)
        others.insert({BINDING_BVH_NODES, BINDING_BVH_TRIANGLES});
    else
        others.insert({BINDING_ACCELERATION_STRUCTURE, BINDING_GEOMETRY_FIRST_TRIANGLES});
    EXPECT_EQ(bare.bindings, arrays);
    EXPECT_EQ(bare.code.bindings, joined(arrays, others));
    EXPECT_FALSE(bare.code.reads_images);
    EXPECT_EQ(bare.code.functions, std::set<std::string>{});
    EXPECT_EQ(bare.code.material_members, (std::set<std::string>{"diffuse_albedo", "emission"}));
    EXPECT_FALSE(bare.code.parameter_members.contains("background"));
    EXPECT_TRUE(bare.code.parameter_members.contains("max_path_length")) << "too weak: parameters are not found";
    EXPECT_GT(bare.code.instructions, 100u);
}

void FeatureCode::expect_each_feature_alone(Backend backend) const {
    const Footprint bare = footprint(bare_scene(), backend);
    for (const SceneFeature& feature : all_scene_features()) {
        SCOPED_TRACE(feature.name);
        Needs needs = needs_of_features().at(feature.name);
        if (!needs.functions.empty() && needs.functions.contains("sample_dielectric") && !handles_dielectrics(GetParam()))
            continue;
        if (feature.name == "area lights" && !samples_lights(GetParam())) needs = {};
        if (feature.name == "area lights" && !weights_lights(GetParam())) needs.material_members = {};
        if (feature.name == "area lights" && load_chapter(GetParam()).handles.light_tree) {
            needs.bindings.insert({BINDING_LIGHT_NODES, BINDING_LIGHT_LEAVES, BINDING_LIGHT_PLACES});
            needs.functions = {"choose_light_by_tree"};
        }
        if (feature.name == "light probe" && !load_chapter(GetParam()).handles.light_probe_sampling) {
            needs.bindings.erase(BINDING_PROBE_CELLS);
            needs.functions.erase("choose_probe_cell");
        }
        const bool has_no_use =
            (feature.name == "microfacets" && !handles_microfacets(GetParam())) ||
            (feature.name == "lens" && !load_chapter(GetParam()).handles.lens) ||
            ((feature.name == "media" || feature.name == "densities") && !load_chapter(GetParam()).handles.media);
        if (has_no_use) needs = {};
        Scene scene = bare_scene();
        feature.add(scene);
        const Footprint actual = footprint(scene, backend);
        EXPECT_EQ(actual.bindings, joined(bare.bindings, needs.bindings));
        EXPECT_EQ(actual.code.bindings, joined(bare.code.bindings, needs.bindings));
        EXPECT_EQ(actual.code.functions, needs.functions);
        EXPECT_EQ(actual.code.material_members, joined(bare.code.material_members, needs.material_members));
        EXPECT_EQ(actual.code.parameter_members, joined(bare.code.parameter_members, needs.parameter_members));
        EXPECT_EQ(actual.code.reads_images, needs.reads_images);
        EXPECT_FALSE(actual.code.has_samplers);
        if (has_no_use) {
            EXPECT_EQ(actual.code.instructions, bare.code.instructions);
        } else if (feature.name != "area lights") {
            EXPECT_GT(actual.code.instructions, bare.code.instructions);
        }
    }
}

// The native backend translates the shaders of compute.
TEST_P(FeatureCode, OfABareSceneIsOfNoFeature) {
    for (const Backend backend : {pipeline_backend, query_backend, compute_backend}) {
        SCOPED_TRACE(to_string(backend));
        if (is_supported(backend, test_device().description())) expect_no_feature_in_bare_scene(backend);
    }
}

// So the test above would find each of them.
TEST_P(FeatureCode, HasWhatEachFeatureNeedsAndNothingElse) { expect_each_feature_alone(compute_backend); }

// The chapters' code is the same on all backends.
TEST_P(FeatureCode, OfTheDriversBackendsHasWhatEachFeatureNeedsAndNothingElse_all) {
    for (const Backend backend : {pipeline_backend, query_backend}) {
        SCOPED_TRACE(to_string(backend));
        if (is_supported(backend, test_device().description())) expect_each_feature_alone(backend);
    }
}

INSTANTIATE_TEST_SUITE_P(Chapters, FeatureCode, testing::ValuesIn(all_chapters), chapter_name);

}  // namespace
}  // namespace lab
