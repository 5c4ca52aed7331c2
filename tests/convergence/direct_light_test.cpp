// Direct light against Lambert's exact formula for polygons: next event estimation, and light that bounces find.
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>

#include "support/expect_statistics.h"
#include "support/failure_images.h"
#include "support/lambert_polygon.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec3;
using glm::mat4;
using std::numbers::pi;
using Corners = std::vector<dvec3>;

const vec3 albedo(0.8f, 0.5f, 0.2f), colour(1, 2, 0.5f);

void add_triangle(Scene& scene, const Corners& corners, uint32_t material) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    for (const dvec3& corner : corners) scene.positions.emplace_back(corner);
    scene.triangles.emplace_back(first, first + 1, first + 2);
    scene.triangle_materials.push_back(material);
    ++scene.meshes.back().triangle_count;
}

// A square of edge length 1, seen from so close that no light gets between it and the camera. Points are given in its own
// coordinates, with z along its normal, and rotated into world space, so that it may be a floor or a wall.
class Receiver {
  public:
    explicit Receiver(const dvec3& normal) : normal_(glm::normalize(normal)) {
        tangent_ = glm::normalize(glm::cross(normal_, dvec3(0.36, -0.48, 0.8)));
        bitangent_ = glm::cross(normal_, tangent_);
    }

    dvec3 to_world(const dvec3& p) const { return centre_ + p.x * tangent_ + p.y * bitangent_ + p.z * normal_; }

    // Corners of a light in world space, ordered so that it faces the receiver.
    Corners place(Corners light) const {
        const dvec3 front = glm::cross(light[1] - light[0], light[2] - light[0]);
        if (glm::dot(front, light[0]) > 0) std::reverse(light.begin() + 1, light.end());
        for (dvec3& corner : light) corner = dvec3(vec3(to_world(corner)));
        return light;
    }

    // Material 0; lights may follow.
    Scene scene(const std::vector<vec3>& emissions = {colour}) const {
        std::vector<Material> materials{diffuse_material(albedo)};
        for (const vec3& emission : emissions) materials.push_back(diffuse_material(vec3(0), emission));
        Scene scene = make_scene(materials, {{vec3(to_world({-0.5, -0.5, 0})), vec3(tangent_), vec3(bitangent_), 0}});
        scene.camera = {.position = vec3(to_world({0.02, -0.3, 0.2})),
                        .target = vec3(to_world({0, 0, 0})),
                        .up = vec3(normal_),
                        .vertical_fov = 25};
        return scene;
    }

    // The mean over each pixel of a function of the visible point, by a Gauss quadrature with 3 x 3 points.
    std::vector<double> image_of(const std::function<double(const dvec3& point)>& function) const {
        const Camera camera = make_camera(scene().camera, size, size);
        constexpr double nodes[] = {-0.7745966692414834, 0, 0.7745966692414834}, weights[] = {5, 8, 5};
        std::vector<double> image(size * size);
        for (size_t i = 0; i < image.size(); ++i)
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) {
                    const double s = (2.0 * static_cast<double>(i % size) + 1 + nodes[a]) / size - 1,
                                 t = (2.0 * static_cast<double>(i / size) + 1 + nodes[b]) / size - 1;
                    const dvec3 origin(camera.position),
                        direction = dvec3(camera.forward) + s * dvec3(camera.right) - t * dvec3(camera.up);
                    const double distance = glm::dot(centre_ - origin, normal_) / glm::dot(direction, normal_);
                    const dvec3 point = origin + distance * direction;
                    EXPECT_LT(std::abs(glm::dot(point - centre_, tangent_)), 0.45);
                    EXPECT_LT(std::abs(glm::dot(point - centre_, bitangent_)), 0.45);
                    image[i] += weights[a] * weights[b] / 324 * function(point);
                }
        return image;
    }

    std::vector<double> irradiance(const Corners& light) const {
        return image_of([&](const dvec3& x) { return polygon_irradiance(light, x, normal_); });
    }

    static constexpr uint32_t size = 16;  // of the image

  private:
    dvec3 centre_{0.3, -0.2, 0.5};
    dvec3 normal_, tangent_, bitangent_;
};

struct Limits {
    double image, pixel;  // largest bias that may go unnoticed, relative to the image's mean
};

// The image is the albedo times the incoming light: colour · irradiance / π plus the part of the sky that no light covers.
void expect_direct_light(const std::string& what, const Batches& batches, const std::vector<double>& irradiance,
                         const Limits& limits, size_t comparisons, double sky = 0) {
    const auto radiance = [&](double e, int channel) {
        return double{albedo[channel]} * (double{colour[channel]} * e / pi + sky * (1 - e / pi));
    };
    double mean = 0;
    for (const double e : irradiance) mean += e / static_cast<double>(irradiance.size());
    const int failed_before = failed_expectations();
    std::vector<Difference> of_image, of_pixels;
    ZMap map{batches.width, batches.height, std::vector<double>(irradiance.size())};
    Image expected{batches.width, batches.height, {}};
    for (const double e : irradiance)
        for (int channel = 0; channel < 3; ++channel) expected.pixels.push_back(static_cast<float>(radiance(e, channel)));
    for (int channel = 0; channel < 3; ++channel)
        of_image.push_back(difference_from(batches.means(channel), radiance(mean, channel)).relative_to(radiance(mean, channel)));
    for (uint32_t i = 0; i < irradiance.size(); ++i) {
        const std::vector<double> means = batches.means(1, {i % batches.width, i / batches.width}, {1, 1});
        if (irradiance[i] == 0) {
            // The quadrature may have missed a corner of the pixel that sees a corner of the light.
            ASSERT_LE(estimate_mean(means).mean, 1e-4 * radiance(mean, 1));
            continue;
        }
        of_pixels.push_back(difference_from(means, radiance(irradiance[i], 1)).relative_to(radiance(mean, 1)));
        const Difference& difference = of_pixels.back();
        if (difference.standard_error > 0) map.values[i] = difference.value / difference.standard_error;
    }
    expect_no_difference(what + ", image", of_image, limits.image, 2 * comparisons);
    expect_no_difference(what + ", pixels", of_pixels, limits.pixel, 2 * comparisons);
    if (failed_expectations() > failed_before) write_failure(what, batches.mean_image(), expected, map);
}

RenderSettings settings_of(const std::string& chapter, uint32_t samples, uint32_t seed) {
    RenderSettings settings{.width = Receiver::size,
                            .height = Receiver::size,
                            .samples = samples,
                            .max_path_length = 1,
                            .seed = chapter_seed(chapter) + seed};
    settings.estimator = chapter_estimator(chapter);
    return settings;
}

constexpr uint32_t light_batches = 32;

// A receiver and a triangular light that faces it.
struct LightCase {
    std::string name;
    dvec3 normal;
    Corners light;
};

const std::vector<LightCase>& light_cases() {
    static const std::vector<LightCase> cases = [] {
        std::vector<LightCase> all;
        std::mt19937 random(7);
        const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<>(low, high)(random); };
        // Random triangles that the middle of the receiver does not see edge-on, where noise would hide them.
        const auto triangle_in = [&](const dvec3& low, const dvec3& high) {
            while (true) {
                Corners light;
                for (int i = 0; i < 3; ++i)
                    light.push_back({uniform(low.x, high.x), uniform(low.y, high.y), uniform(low.z, high.z)});
                const Corners back(light.rbegin(), light.rend());
                const dvec3 up(0, 0, 1);
                if (polygon_irradiance(light, dvec3(0), up) + polygon_irradiance(back, dvec3(0), up) > 0.03) return light;
            }
        };
        const auto scaled = [](Corners light, double scale, const dvec3& centre) {
            for (dvec3& corner : light) corner = centre + scale * corner;
            return light;
        };
        const Corners shape{{-0.9, 0.2, 0.5}, {0.3, 0.8, -0.6}, {0.6, -0.7, 0.1}};
        const dvec3 floor(0, 1, 0), walls[] = {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {0, -1, 0}};
        for (int i = 0; i < 10; ++i) {
            const dvec3 normal = i < 3 ? floor : i < 8 ? walls[i - 3] : dvec3(uniform(-1, 1), uniform(-1, 1), 0.5);
            all.push_back({"random " + std::to_string(i), normal, triangle_in({-1, -1, 0.4}, {1, 1, 1.6})});
        }
        for (int i = 0; i < 5; ++i)
            all.push_back({"partly below the horizon " + std::to_string(i), i < 2 ? floor : walls[i - 2],
                           triangle_in({1, -1, -0.8}, {2, 1, 1})});
        all.push_back({"far above", floor, scaled(shape, 1, {100, -200, 900})});
        all.push_back({"far and low", walls[0], scaled(shape, 1, {900, 300, 60})});
        all.push_back({"far to the side of a wall", walls[3], scaled(shape, 1, {-700, 700, 300})});
        all.push_back({"tiny", floor, scaled(shape, 1e-3, {0.5, 0.2, 0.9})});
        all.push_back({"tinier, on a wall", walls[1], scaled(shape, 1e-5, {-0.3, 0.5, 0.6})});
        all.push_back({"huge", walls[2], {{-6, -5, 2}, {7, -4, 2.5}, {0, 8, 3}}});
        all.push_back({"narrow", floor, {{-1, 0.5, 0.7}, {1, 0.5, 0.8}, {0.2, 0.55, 0.65}}});
        all.push_back({"sliver", floor, {{-1, 0.5, 0.7}, {1, 0.5, 0.8}, {0.2, 0.5002, 0.75}}});
        all.push_back({"just above the horizon", floor, {{1, -0.5, 0.01}, {1.2, 0.5, 0.02}, {1.1, 0, 0.1}}});
        all.push_back({"seen from the side", walls[4], {{-0.3, 0.5, 0.5}, {0.4, 0.6, 0.62}, {0.1, 1.6, 1.25}}});
        return all;
    }();
    return cases;
}

class DirectLight : public OnEachChapter {};
INSTANTIATE_TEST_SUITE_P(Chapters, DirectLight, testing::ValuesIn(chapters_that(samples_lights)), own_estimator_name);

TEST_P(DirectLight, OfATriangleIsThatOfLambert) {
    uint32_t seed = 100;
    for (const auto& [name, normal, light] : light_cases()) {
        const Receiver receiver(normal);
        Scene scene = receiver.scene();
        add_triangle(scene, receiver.place(light), 1);
        const Batches batches = render_batches(scene, settings_of(GetParam(), 80, ++seed), light_batches);
        expect_direct_light(name, batches, receiver.irradiance(receiver.place(light)), {0.02, 0.7}, light_cases().size());
    }
}

TEST_P(DirectLight, OfTransformedInstancesIsThatOfTheirImages) {
    // A triangle in its own mesh, placed three times: unchanged, scaled unevenly and rotated, and mirrored, where its front stays
    // on the same side of the object.
    const Receiver receiver({0, 0, 1});
    Scene scene = receiver.scene();
    const Corners light{{-0.3, 0, 0}, {0.2, 0.4, 0.1}, {0.3, -0.3, 0}};
    Mesh lamp{.file = "lamp", .first_triangle = 2};
    scene.meshes.push_back(lamp);
    add_triangle(scene, light, 1);
    std::vector<double> irradiance(size_t{Receiver::size} * Receiver::size);
    const mat4 identity(1);
    const mat4 placements[] = {
        glm::scale(glm::rotate(identity, 0.3f, vec3(1, 0.2f, 0)), vec3(1)),
        glm::scale(glm::rotate(identity, -0.4f, vec3(0.3f, 1, 0)), vec3(0.5f, 2, 1)),
        glm::scale(glm::rotate(identity, 0.5f, vec3(0, 1, 0.1f)), vec3(-1.5f, 0.7f, 1)),
    };
    for (int k = 0; k < 3; ++k) {
        const vec3 centre(receiver.to_world(dvec3(0.8 * (k - 1), 0.3, 0.9 + 0.2 * k)));
        const mat4 placement = glm::translate(identity, centre) * placements[k];
        scene.instances.push_back(
            {.object_to_world = mat4x3(placement), .normal_to_world = glm::transpose(glm::inverse(mat3(placement)))});
        scene.instance_meshes.push_back(1);
        Corners image;
        for (const dvec3& corner : light) image.emplace_back(placement * glm::vec4(vec3(corner), 1));
        if (glm::determinant(mat3(placement)) < 0) std::swap(image[1], image[2]);
        const auto of_light = receiver.irradiance(image);
        EXPECT_GT(*std::min_element(of_light.begin(), of_light.end()), 0.01) << "light " << k << " faces away";
        for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] += of_light[i];
    }
    const Batches batches = render_batches(scene, settings_of(GetParam(), 64, 1), light_batches);
    expect_direct_light("three instances", batches, irradiance, {0.02, 0.5}, 1);
}

TEST_P(DirectLight, IsBlockedCloseToTheLight) {
    const Receiver receiver({0, 1, 0});
    Scene scene = receiver.scene();
    add_triangle(scene, receiver.place({{-1, -1, 1}, {1, -1, 1}, {0, 1.2, 1}}), 1);
    // A little below the light, and a little larger.
    add_triangle(scene, receiver.place({{-1.5, -1.3, 0.97}, {1.5, -1.3, 0.97}, {0, 1.7, 0.97}}), 0);
    for (const FilmPixel& pixel : render(scene, settings_of(GetParam(), 64, 1)).pixels) ASSERT_EQ(pixel.sum, vec3(0));
}

TEST_P(DirectLight, AddsToTheLightOfTheSky) {
    // The light hides the part of the sky that it covers.
    const double sky = 0.3;
    const Receiver receiver(dvec3(1, 2, -1));
    const Corners light = receiver.place(light_cases()[0].light);
    Scene scene = receiver.scene();
    scene.background = vec3(static_cast<float>(sky));
    add_triangle(scene, light, 1);
    const Batches batches = render_batches(scene, settings_of(GetParam(), 64, 1), light_batches);
    expect_direct_light("light and sky", batches, receiver.irradiance(light), {0.02, 0.5}, 1, sky);
}

class AllChapters : public OnEachChapter {};
INSTANTIATE_TEST_SUITE_P(DirectLight, AllChapters, testing::ValuesIn(all_chapters), own_estimator_name);

TEST_P(AllChapters, FindTheLightOfATriangleByBounces) {
    // Lights large enough to be found by chance.
    uint32_t seed = 200;
    for (const size_t i : {size_t{0}, size_t{4}, size_t{20}}) {
        const auto& [name, normal, light] = light_cases()[i];
        const Receiver receiver(normal);
        Scene scene = receiver.scene();
        add_triangle(scene, receiver.place(light), 1);
        RenderSettings settings = settings_of(GetParam(), 450, ++seed);
        settings.strategy = Strategy::bounces;
        expect_direct_light(name, render_batches(scene, settings, light_batches), receiver.irradiance(receiver.place(light)),
                            {0.05, 2}, 3);
    }
}

TEST_P(AllChapters, GiveExactlyNothingWithoutLight) {
    const Receiver receiver({0, 1, 0});
    Corners turned = receiver.place(light_cases()[0].light);
    std::swap(turned[1], turned[2]);
    Scene dark = receiver.scene(), turned_away = dark;
    add_triangle(turned_away, turned, 1);
    for (const Scene& scene : {dark, turned_away})
        for (const FilmPixel& pixel : render(scene, settings_of(GetParam(), 64, 1)).pixels) ASSERT_EQ(pixel.sum, vec3(0));
}

}  // namespace
}  // namespace lab
