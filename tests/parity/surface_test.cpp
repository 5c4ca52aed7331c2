// Cameras, sides of surfaces, instances and normals on every backend.
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "support/expect_statistics.h"
#include "support/gpu_test.h"
#include "support/render.h"
#include "support/scenes.h"

namespace lab {
namespace {

using glm::dvec2;
using glm::dvec3;
using std::numbers::pi;

class Surface : public OnEachBackend {
  protected:
    FilmImage render_view(const Scene& scene, const std::string& view, uint32_t samples = 1) const {
        return render(scene,
                      {.width = 16, .height = 16, .samples = samples, .estimator = view_estimator(view), .backend = GetParam()});
    }
    // Radiance of a single pixel, where all camera rays see the same.
    vec3 radiance(const Scene& scene, uint32_t max_path_length, uint32_t samples = 1) const {
        return radiance_at(
            render(scene,
                   {.width = 1, .height = 1, .samples = samples, .max_path_length = max_path_length, .backend = GetParam()}),
            0, 0);
    }
};
INSTANTIATE_TEST_SUITE_P(Backends, Surface, testing::ValuesIn(all_backends), backend_name);

// A square of edge length 2 around the origin that faces +Z, seen from +Z (or from -Z, its back).
Scene square(const Material& material, float camera_z = 1) {
    Scene scene = make_scene({material}, {{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}});
    scene.camera = {.position = {0, 0, camera_z}, .target = {0, 0, 0}, .up = {0, 1, 0}, .vertical_fov = 10};
    return scene;
}

// Where a point appears in the image, in pixels from the upper left corner: projected by hand.
dvec2 project(const dvec3& point, const CameraPose& pose, double width, double height) {
    const dvec3 forward = glm::normalize(dvec3(pose.target) - dvec3(pose.position));
    const dvec3 right = glm::normalize(glm::cross(forward, dvec3(pose.up)));
    const dvec3 up = glm::cross(right, forward);
    const dvec3 offset = point - dvec3(pose.position);
    const double scale = 0.5 * height / std::tan(glm::radians(0.5 * pose.vertical_fov)) / glm::dot(offset, forward);
    return {0.5 * width + scale * glm::dot(offset, right), 0.5 * height - scale * glm::dot(offset, up)};
}

// Centre of brightness in pixels.
dvec2 brightest_point(const FilmImage& film) {
    dvec2 sum(0);
    double total = 0;
    for (uint32_t y = 0; y < film.height; ++y)
        for (uint32_t x = 0; x < film.width; ++x) {
            const double brightness = radiance_at(film, x, y).r;
            sum += brightness * dvec2(x + 0.5, y + 0.5);
            total += brightness;
        }
    return sum / total;
}

TEST_P(Surface, AppearsWhereTheCameraSeesIt) {
    // For the first camera a lamp up and to the right of the centre; the others look from elsewhere or lie on their side.
    const dvec3 lamp(0.7, 1.1, 0);
    for (const CameraPose& pose :
         {CameraPose{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 50}, CameraPose{{0, 0, 5}, {0, 0, 0}, {1, 0, 0}, 50},
          CameraPose{{2, -1, 4}, {0.3f, 0.5f, -1}, {0.2f, 1, 0.3f}, 35}}) {
        Scene scene =
            make_scene({diffuse_material(vec3(0), vec3(1))}, {{vec3(lamp) - vec3(0.1f, 0.1f, 0), {0.2f, 0, 0}, {0, 0.2f, 0}}});
        scene.camera = pose;
        const FilmImage film =
            render(scene, {.width = 96, .height = 64, .samples = 64, .max_path_length = 0, .backend = GetParam()});
        const dvec2 expected = project(lamp, pose, 96, 64), found = brightest_point(film);
        EXPECT_NEAR(found.x, expected.x, 0.1);
        EXPECT_NEAR(found.y, expected.y, 0.1);
    }
}

TEST_P(Surface, EmitsFromItsFrontOnly) {
    const Material lamp = diffuse_material(vec3(0.5f), {1, 2, 3});
    EXPECT_EQ(radiance(square(lamp), 0), vec3(1, 2, 3));
    EXPECT_EQ(radiance(square(lamp, -1), 0), vec3(0));
}

TEST_P(Surface, ReflectsOnBothSides) {
    for (const float camera_z : {1.0f, -1.0f}) {
        Scene scene = square(diffuse_material({0.25f, 0.5f, 1}), camera_z);
        scene.background = vec3(1);
        const FilmImage film = render(scene, {.samples = 64, .max_path_length = 1, .backend = GetParam()});
        const vec3 albedo = scene.materials.front().diffuse_albedo;
        for (int channel = 0; channel < 3; ++channel)
            expect_mean(camera_z > 0 ? "front" : "back", estimate_mean(pixel_means(film, channel)), albedo[channel], 0.01, 6);
    }
}

TEST_P(Surface, KeepsItsFrontInTransformedInstances) {
    using glm::mat4;
    const mat4 identity(1);
    const struct {
        const char* name;
        mat4 transform;
        bool is_front_at_positive_z;
    } cases[] = {
        {"scaled unevenly", glm::scale(identity, vec3(2, 1, 3)), true},
        {"mirrored in its plane", glm::scale(identity, vec3(-1, 1, 1)), true},
        {"mirrored through its plane", glm::scale(identity, vec3(1, 1, -1)), false},
        {"mirrored through the origin", glm::scale(identity, vec3(-1, -1, -1)), false},
        {"turned around", glm::rotate(identity, static_cast<float>(pi), vec3(0, 1, 0)), false},
        {"moved", glm::translate(identity, vec3(0.3f, 0.2f, -5)), true},
    };
    for (const auto& [name, transform, is_front_at_positive_z] : cases)
        for (const float camera_z : {1.0f, -1.0f}) {
            Scene scene = square(diffuse_material(vec3(0), vec3(1)), camera_z);
            set_transform(scene, glm::mat4x3(transform));
            if (camera_z < 0) scene.camera.position.z = -10;  // behind the translated one
            EXPECT_EQ(radiance(scene, 0).r, (camera_z > 0) == is_front_at_positive_z ? 1 : 0) << name << ", camera " << camera_z;
        }
}

TEST_P(Surface, HasTheNormalsOfItsVertices) {
    Scene scene = square(diffuse_material(vec3(1)));
    const vec3 normal = glm::normalize(vec3(0.4f, -0.2f, 1));
    scene.normals.assign(scene.positions.size(), normal);
    EXPECT_LT(glm::distance(radiance_at(render_view(scene, "normals"), 3, 5), 0.5f + 0.5f * normal), 1e-6f);
    // From behind, the other side's normal is visible.
    scene.camera.position.z = -1;
    EXPECT_LT(glm::distance(radiance_at(render_view(scene, "normals"), 3, 5), 0.5f - 0.5f * normal), 1e-6f);
    // A plane's normal must be transformed into the normal of the transformed plane.
    set_transform(scene, mat4x3(2, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0, 0, 0));
    const vec3 transformed = glm::normalize(normal / vec3(2, 1, 0.5f));
    EXPECT_LT(glm::distance(radiance_at(render_view(scene, "normals"), 3, 5), 0.5f - 0.5f * transformed), 1e-6f);
}

TEST_P(Surface, InterpolatesTheNormalsOfItsVertices) {
    Scene scene = square(diffuse_material(vec3(1)));
    scene.camera.vertical_fov = 1;
    // Both triangles contain the centre of the square, where opposite corners have equal weights.
    const std::vector<vec3> normals{{0.5f, 0, 1}, {0, 0, 1}, {0, 0.5f, 1}, {0, 0, 1}};
    for (const vec3& normal : normals) scene.normals.push_back(glm::normalize(normal));
    const vec3 expected = glm::normalize(scene.normals[0] + scene.normals[2]);
    EXPECT_LT(glm::distance(radiance_at(render_view(scene, "normals"), 8, 8), 0.5f + 0.5f * expected), 0.01f);
}

TEST_P(Surface, IsHitInTheNearestOfSeveralLayers) {
    // Layers, not sorted by depth.
    std::vector<Material> materials;
    std::vector<Quad> quads;
    for (const int depth : {3, 0, 4, 1, 2}) {
        materials.push_back(diffuse_material(vec3(0), vec3(1.0f + static_cast<float>(depth))));
        quads.push_back({{-1, -1, -static_cast<float>(depth)}, {2, 0, 0}, {0, 2, 0}, static_cast<uint32_t>(quads.size())});
    }
    Scene scene = make_scene(materials, quads);
    scene.camera = square(materials[0]).camera;
    EXPECT_EQ(radiance(scene, 0), vec3(1));
    scene.camera.position.z = -1.5f;
    scene.camera.target.z = -10;
    EXPECT_EQ(radiance(scene, 0), vec3(3));
}

}  // namespace
}  // namespace lab
