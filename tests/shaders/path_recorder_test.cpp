// The path recorder records exactly the path that the estimator follows.
#include "inspection/path_recorder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <regex>

#include "inspection/projection.h"
#include "support/dielectric_scenes.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"
#include "support/temporary_folder.h"
#include "tracing/vulkan_backends.h"

namespace lab {
namespace {

constexpr uint32_t image_extent = 24;

struct Recorded {
    uvec2 pixel;
    uint32_t sample;
    RecordedPath path;
};

// Paths of `count` pixels spread over the image, with varying sample indices.
std::vector<Recorded> record_paths(const Scene& scene, const RenderSettings& settings, uint32_t count) {
    const GpuScene gpu_scene(test_device(), scene, settings.strategy,
                             {.light_probe_sampling = scene.light_probe.has_value(), .media = !scene.media.empty()});
    const auto scene_backend = settings.backend->build(test_device(), gpu_scene);
    PathRecorder recorder(test_device(), *scene_backend, settings.estimator, make_parameters(scene, settings));
    std::vector<Recorded> paths;
    for (uint32_t i = 0; i < count; ++i) {
        const uint32_t index = i * 7919 % (settings.width * settings.height);
        const uvec2 pixel(index % settings.width, index / settings.width);
        paths.push_back({pixel, i % 5, recorder.record(make_parameters(scene, settings), pixel, i % 5)});
        EXPECT_TRUE(paths.back().path.is_complete);
    }
    return paths;
}

RenderSettings settings_for(const std::string& chapter) {
    RenderSettings settings{.width = image_extent, .height = image_extent, .max_path_length = 6};
    settings.splitting_factor = 2;
    settings.roulette_start = 2;
    settings.estimator = chapter_estimator(chapter);
    return settings;
}

Scene scene_for(const std::string& chapter) {
    return load_shipped_scene(handles_dielectrics(chapter) ? "glass.json" : "cornell_box.json");
}

class PathRecorderOf : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(, PathRecorderOf, testing::ValuesIn(all_chapters), own_estimator_name);

TEST_P(PathRecorderOf, RecordsTheSampleThatTheRenderAdds) {
    if (has_light_paths(GetParam())) return;  // other samples add to the pixel, too: see RecordsLightPaths
    const Scene scene = scene_for(GetParam());
    const RenderSettings settings = settings_for(GetParam());
    const uint32_t paths = samples_lights(GetParam()) ? 40 : 300;  // bounces rarely hit the light
    std::vector<FilmImage> films;
    for (uint32_t sample = 0; sample < 5; ++sample) {
        RenderSettings one = settings;
        one.first_sample = sample;
        one.samples = 1;
        films.push_back(render(scene, one));
    }
    uint32_t bright = 0;
    for (const auto& [pixel, sample, path] : record_paths(scene, settings, paths)) {
        EXPECT_EQ(path.radiance, films[sample].pixels[pixel.y * image_extent + pixel.x].sum)
            << "pixel " << pixel.x << "," << pixel.y << " sample " << sample;
        bright += path.radiance != vec3(0);
    }
    EXPECT_GT(bright, 3u);
}

TEST_P(PathRecorderOf, FollowsRaysFromSurfaceToSurface) {
    const Scene scene = scene_for(GetParam());
    size_t hits = 0, longest = 0, splits = 0;
    for (const auto& [pixel, sample, path] : record_paths(scene, settings_for(GetParam()), 40)) {
        ASSERT_FALSE(path.vertices.empty());
        EXPECT_EQ(path.vertices.front().parent, -1);
        EXPECT_EQ(path.vertices.front().origin, scene.camera.position);
        longest = std::max(longest, path.vertices.size());
        std::vector<int> children(path.vertices.size());
        for (size_t i = 0; i < path.vertices.size(); ++i) {
            const PathVertex& vertex = path.vertices[i];
            EXPECT_NEAR(glm::length(vertex.direction), 1, 1e-5f);
            if (i > 0) {
                ASSERT_GE(vertex.parent, 0);
                ASSERT_LT(vertex.parent, static_cast<int>(i));
                EXPECT_LT(glm::length(path.vertices[static_cast<size_t>(vertex.parent)].position - vertex.origin), 1e-4f);
                splits += ++children[static_cast<size_t>(vertex.parent)] == 2;
            }
            if (!vertex.is_hit) continue;
            ++hits;
            EXPECT_LT(glm::length(glm::cross(vertex.position - vertex.origin, vertex.direction)), 1e-4f);
            EXPECT_LT(glm::dot(vertex.normal, vertex.direction), 0);
        }
    }
    EXPECT_GT(hits, 80u);
    EXPECT_GT(longest, 4u);
    EXPECT_EQ(splits > 0, splits_paths(GetParam()));
}

TEST_P(PathRecorderOf, TellsWhereRadianceWasFound) {
    RenderSettings settings = settings_for(GetParam());
    settings.splitting_factor = 1;  // if paths split, each branch has weight 1/s
    uint32_t visible = 0, occluded = 0;
    for (const auto& [pixel, sample, path] : record_paths(scene_for(GetParam()), settings, 60)) {
        vec3 sum(0);
        for (const PathVertex& vertex : path.vertices) {
            sum += vertex.radiance;
            for (const LightSample& light : vertex.light_samples) {
                ++(light.is_visible ? visible : occluded);
                EXPECT_TRUE(light.point);
                EXPECT_EQ(light.radiance.g > 0, light.is_visible);
                EXPECT_LE(light.radiance.g, vertex.radiance.g);
            }
        }
        EXPECT_LT(glm::length(sum - path.radiance), 1e-5f * (1 + glm::length(path.radiance)));
    }
    EXPECT_EQ(visible > 20, samples_lights(GetParam()));
    EXPECT_EQ(occluded > 3, samples_lights(GetParam()));
}

TEST(PathRecorder, KnowsThatASampleOfTheSkyHasNoPoint) {
    size_t samples = 0;
    for (const auto& [pixel, sample, path] :
         record_paths(load_shipped_scene("sunny.json"), settings_for(chapter_named("light_probes")), 60))
        for (const PathVertex& vertex : path.vertices)
            for (const LightSample& light : vertex.light_samples) {
                ++samples;
                EXPECT_FALSE(light.point);
                EXPECT_NEAR(glm::length(light.direction), 1, 1e-5f);
            }
    EXPECT_GT(samples, 20u);
}

TEST_P(PathRecorderOf, MultipliesTheThroughputOfAFurnace) {
    // Every bounce reflects (0.9, 0.5, 0.3) of the light, and from chapter 2 on all directions have equal weight.
    const vec3 albedo(0.9f, 0.5f, 0.3f);
    const bool is_weighted_alike = weighs_by_albedo(GetParam());
    const bool may_end = has_roulette(GetParam());
    uint32_t survived = 0, lost = 0;
    for (const auto& [pixel, sample, path] : record_paths(closed_box(diffuse_material(albedo)), settings_for(GetParam()), 30)) {
        for (const PathVertex& vertex : path.vertices) {
            lost += static_cast<uint32_t>(vertex.lost_roulettes.size());
            if (vertex.parent < 0) {
                EXPECT_EQ(vertex.throughput, vec3(1));
                continue;
            }
            const PathVertex& before = path.vertices[static_cast<size_t>(vertex.parent)];
            vec3 expected = before.throughput * albedo;
            if (vertex.survival_probability) {
                ++survived;
                EXPECT_NEAR(*vertex.survival_probability, std::min(expected.r, 0.95f), 1e-6f);
                expected /= *vertex.survival_probability;
            }
            if (is_weighted_alike)
                EXPECT_LT(glm::length(vertex.throughput - expected), 1e-5f);
            else  // colours have the ratios of the albedo
                EXPECT_NEAR(vertex.throughput.r * expected.g, vertex.throughput.g * expected.r, 1e-5f);
        }
    }
    EXPECT_EQ(survived > 10, may_end);
    EXPECT_EQ(lost > 3, may_end);
}

// A box of a thin medium without a surface, and a lamp above it that looks down.
Scene box_of_medium_below_a_lamp() {
    Scene scene = make_scene({diffuse_material(vec3(0)), diffuse_material(vec3(0), vec3(10))}, [] {
        auto quads = box_sides(vec3(-1), vec3(1), 0, Facing::outwards);
        quads.push_back({{-0.5f, 3, -0.5f}, {1, 0, 0}, {0, 0, 1}, 1});
        return quads;
    }());
    auto box = scene.meshes[0], lamp = scene.meshes[0];
    box.triangle_count = 12;
    lamp.first_triangle = 12, lamp.triangle_count = 2;
    scene.meshes = {box, lamp};
    scene.instance_meshes = {0, 1};
    scene.instances.push_back(scene.instances[0]);
    fill(scene, homogeneous_medium(1.5f, vec3(0.9f), 0.3f));
    scene.camera = {.position = {0, 0, 4}, .target = {0, 0, 0}, .vertical_fov = 40};
    return scene;
}

// Rays end at collisions, also the last one of a path. Light samples start there or, if they are sampled by angles, on a ray.
TEST(PathRecorder, EndsRaysInMediaAtCollisions_all) {
    const auto is_on = [](const vec3& point, const PathVertex& vertex) {  // some are thousands of units away
        return glm::length(glm::cross(point - vertex.origin, vertex.direction)) < 1e-4f + 1e-6f * glm::length(point);
    };
    for (const bool is_fog : {true, false})
        for (const bool has_angles : {false, true}) {
            RenderSettings settings = settings_for(chapter_named("media"));
            if (has_angles) settings.estimator.defines = {"DISTANCE_SAMPLING SAMPLES_ANGLES"};
            const Scene scene = is_fog ? load_shipped_scene("fog.json") : box_of_medium_below_a_lamp();
            SCOPED_TRACE(std::string(is_fog ? "fog" : "a box") + (has_angles ? ", angles" : ""));
            size_t collisions = 0, last_collisions = 0, bright = 0;
            for (const auto& [pixel, sample, path] : record_paths(scene, settings, 100)) {
                vec3 sum(0);
                for (size_t i = 0; i < path.vertices.size(); ++i) {
                    const PathVertex& vertex = path.vertices[i];
                    sum += vertex.radiance;
                    ASSERT_EQ(vertex.parent, static_cast<int>(i) - 1) << "a ray of no path";
                    if (i > 0) {
                        const PathVertex& before = path.vertices[i - 1];
                        ASSERT_TRUE(before.is_in_scene());
                        const float rounding = before.is_collision ? 1e-6f : 1e-4f;
                        EXPECT_LT(glm::distance(before.position, vertex.origin), rounding * (1 + glm::length(vertex.origin)));
                    }
                    for (const LightSample& light : vertex.light_samples) {
                        const bool starts_here = glm::distance(light.start, vertex.position) < 1e-4f;
                        EXPECT_TRUE(starts_here ||
                                    (has_angles && std::ranges::any_of(path.vertices, [&](const PathVertex& other) {
                                         return is_on(light.start, other);
                                     })));
                        EXPECT_TRUE(light.point);
                        if (!light.is_visible) {
                            EXPECT_EQ(light.radiance, vec3(0));
                        }
                        bright += light.radiance.g > 0;
                    }
                    if (!vertex.is_collision) continue;
                    EXPECT_FALSE(vertex.is_hit);
                    EXPECT_TRUE(is_on(vertex.position, vertex));
                    EXPECT_TRUE(is_fog || glm::all(glm::lessThan(glm::abs(vertex.position), vec3(1.0001f))));
                    ++collisions;
                    last_collisions += i + 1 == path.vertices.size();
                }
                EXPECT_LT(glm::length(sum - path.radiance), 1e-5f * (1 + glm::length(path.radiance)));
            }
            EXPECT_GT(collisions, 50u);
            EXPECT_GT(last_collisions, 5u);
            EXPECT_GT(bright, 50u);
        }
}

// A picture of one sample per pixel is what the camera paths find and what the light paths send to the pixels that see them.
TEST(PathRecorder, RecordsLightPaths_all) {
    Scene scene = room_with_box(dielectric_material(1.5f), {-0.9f, 0.5f, -0.9f}, {0.9f, 0.6f, 0.9f});  // a pane below the lamp
    RenderSettings settings = settings_for(chapter_named("light_paths"));
    constexpr uint32_t extent = 12;
    settings.width = settings.height = extent;
    settings.samples = 1;
    for (const float aperture : {0.0f, 0.3f}) {
        scene.camera.aperture_diameter = aperture;
        scene.camera.focus_distance = 1;
        settings.backend = aperture > 0 ? fastest_backend() : compute_backend;
        const FilmImage film = render(scene, settings);
        std::vector<vec3> sums(film.pixels.size());
        size_t sent = 0, hidden = 0;
        const RenderParameters parameters = make_parameters(scene, settings);
        const Camera& camera = parameters.camera;
        const GpuScene gpu_scene = make_gpu_scene(scene, settings);
        const auto scene_backend = settings.backend->build(test_device(), gpu_scene);
        PathRecorder recorder(test_device(), *scene_backend, settings.estimator, parameters);
        for (uint32_t i = 0; i < sums.size(); ++i) {
            const RecordedPath path = recorder.record(parameters, {i % extent, i / extent}, 0);
            sums[i] += path.radiance;
            EXPECT_LT(glm::distance(path.vertices.at(0).origin, camera.position), 0.5f * aperture + 1e-5f);
            vec3 start(0);
            for (size_t k = 0; k < path.light_path.size(); ++k) {
                const PathVertex& vertex = path.light_path[k];
                EXPECT_EQ(vertex.parent, static_cast<int>(k) - 1);
                if (k == 0) {
                    EXPECT_NEAR(vertex.origin.y, 0.95f, 1e-5f) << "not from the lamp";
                } else {
                    EXPECT_LT(glm::distance(vertex.origin, start), 1e-4f);
                }
                start = vertex.position;
                ASSERT_LE(vertex.light_samples.size(), 1u);
                for (const LightSample& to_camera : vertex.light_samples) {
                    EXPECT_LT(glm::distance(*to_camera.point, camera.position), 0.5f * aperture + 1e-5f);
                    EXPECT_EQ(to_camera.radiance != vec3(0), to_camera.is_visible);
                    ++(to_camera.is_visible ? sent : hidden);
                    // Rays from all of the aperture meet in the plane in focus.
                    const vec3 towards = vertex.position - *to_camera.point;
                    const vec3 in_focus = *to_camera.point + towards * (1 / glm::dot(towards, camera.forward));
                    const uvec2 pixel(*project(camera, in_focus) * static_cast<float>(extent));
                    if (to_camera.is_visible) sums[pixel.y * extent + pixel.x] += to_camera.radiance;
                }
            }
        }
        for (size_t i = 0; i < sums.size(); ++i)
            EXPECT_LT(glm::length(sums[i] - film.pixels[i].sum), 1e-4f * (1 + glm::length(sums[i]))) << i;
        EXPECT_GT(sent, 30u);
        EXPECT_GT(hidden, 3u);
    }
}

TEST(PathRecorder, SaysWhetherThereIsAThroughputToFollow) {
    RenderSettings settings = settings_for(chapter_named("cosine_sampling"));
    const Scene scene = closed_box(diffuse_material(vec3(0.5f)));
    for (const auto& recorded : record_paths(scene, settings, 4)) EXPECT_TRUE(recorded.path.has_throughput);
    const TemporaryFolder folder;
    const auto copy = folder.path() / "chapter";  // including the technique that it uses
    std::filesystem::copy(settings.estimator.file.parent_path(), copy, std::filesystem::copy_options::recursive);
    std::ifstream original(settings.estimator.file);
    const std::string text{std::istreambuf_iterator<char>(original), {}};
    settings.estimator.file = copy / "path_trace.glsl";
    std::ofstream(settings.estimator.file) << std::regex_replace(text, std::regex("\\bthroughput\\b"), "weight");
    for (const auto& recorded : record_paths(scene, settings, 4)) {
        EXPECT_GT(recorded.path.vertices.size(), 1u);
        EXPECT_FALSE(recorded.path.has_throughput);
    }
}

TEST(PathRecorder, RecordsTheSameOnEveryBackend) {
    const Scene scene = scene_for(chapter_named("next_event_estimation"));
    RenderSettings settings = settings_for(chapter_named("next_event_estimation"));
    const auto expected = record_paths(scene, settings, 20);
    for (const Backend backend : all_backends) {
        if (!is_supported(backend, test_device().description())) continue;
        settings.backend = backend;
        const auto paths = record_paths(scene, settings, 20);
        for (size_t i = 0; i < paths.size(); ++i) {
            ASSERT_EQ(paths[i].path.vertices.size(), expected[i].path.vertices.size());
            EXPECT_LT(glm::length(paths[i].path.radiance - expected[i].path.radiance),
                      1e-3f * (1 + glm::length(expected[i].path.radiance)));
        }
    }
}

// SPIR-V contains the names of a shader's functions and variables.
bool mentions(const std::vector<uint32_t>& words, const std::string& name) {
    const auto bytes = std::as_bytes(std::span(words));
    const auto same = [](std::byte a, char b) { return static_cast<char>(a) == b; };
    return std::search(bytes.begin(), bytes.end(), name.begin(), name.end(), same) != bytes.end();
}

TEST(PathRecorder, LeavesNoTraceInShadersThatRender) {
    const Scene scene = scene_for(chapter_named("russian_roulette"));
    const GpuScene gpu_scene(test_device(), scene);
    const Estimator estimator = chapter_estimator(chapter_named("russian_roulette"));
    const auto compile = [&](const Estimator& e) {
        ShaderSource source = shader_source("engine/render.comp", gpu_scene, e);
        source.defines.push_back("BVH_STACK_SIZE 32");
        return compile_shader(source);
    };
    EXPECT_FALSE(mentions(compile(estimator), "record"));
    EXPECT_TRUE(mentions(compile(recording(estimator)), "record"));
}

}  // namespace
}  // namespace lab
