#include "scene/warnings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "scene/features.h"

namespace lab {
namespace {

constexpr size_t max_triangles = 10'000'000, max_pairs = 10'000'000;

// The triangles of one material in one instance.
struct Part {
    uint32_t instance;
    uint32_t material;
    Bounds bounds;  // world space
};

std::vector<Part> parts_of(const Scene& scene) {
    std::vector<Part> parts;
    size_t triangle_count = 0;
    for (uint32_t i = 0; i < scene.instances.size(); ++i) {
        const Mesh& mesh = scene.mesh_of(i);
        triangle_count += mesh.triangle_count;
        if (triangle_count > max_triangles) break;
        if (mesh.is_open) continue;
        std::map<uint32_t, Bounds> bounds_of_material;
        for (const uint32_t triangle : mesh.triangles()) {
            Bounds& bounds = bounds_of_material[scene.triangle_materials[triangle]];
            for (int corner = 0; corner < 3; ++corner)
                bounds.grow(scene.instances[i].object_to_world * glm::vec4(scene.corner(triangle, corner), 1));
        }
        for (const auto& [material, bounds] : bounds_of_material) parts.push_back({i, material, bounds});
    }
    return parts;
}

// A part whose box lies inside another part's box.
struct Nesting {
    const Part* inner = nullptr;
    const Part* outer = nullptr;
};

bool is_inside(const Bounds& inner, const Bounds& outer) {
    return glm::all(glm::lessThan(outer.low, inner.low)) && glm::all(glm::lessThan(inner.high, outer.high));
}

constexpr double rounding = 0x1p-24;  // relative, of 32-bit numbers

std::string to_text(double number, int digits = 2) {
    char text[16];
    std::snprintf(text, sizeof text, "%.*g", digits, number);
    return text;
}

void check_texture_coordinates(const Scene& scene, std::vector<std::string>& warnings) {
    if (scene.texture_coordinates.empty()) return;
    for (const Mesh& mesh : scene.meshes) {
        float farthest = 0, step = 0, steps_in_texels = 0;
        for (const uint32_t triangle : mesh.triangles()) {
            const int texture = scene.material_of(triangle).albedo_texture;
            if (texture < 0) continue;
            const Texture& image = scene.textures[static_cast<size_t>(texture)];
            for (int i = 0; i < 3; ++i) {
                const vec2 uv = glm::abs(scene.texture_coordinates[scene.triangles[triangle][i]]);
                const float size = std::max(uv.x, uv.y), spacing = std::nextafter(size, INFINITY) - size;
                const float texels = spacing * static_cast<float>(std::max(image.width, image.height));
                if (texels <= steps_in_texels) continue;
                farthest = size;
                step = spacing;
                steps_in_texels = texels;
            }
        }
        if (steps_in_texels > 1)
            warnings.push_back(mesh.file + ": texture coordinates reach " + to_text(farthest, 3) + ", where floats are " +
                               to_text(step) + " apart: steps of " + to_text(steps_in_texels, 3) +
                               " texels show; move them closer to 0");
    }
}

}  // namespace

std::vector<std::string> dielectric_warnings(const Scene& scene, const std::vector<Body>& bodies) {
    if (!features_of(scene).dielectrics) return {};
    const std::vector<Part> parts = parts_of(scene);
    const auto is_dielectric = [&](const Part& part) { return scene.materials[part.material].refractive_index > 0; };

    Nesting nested_dielectric, enclosed_object;  // the first of each kind
    size_t pair_count = 0;
    for (const Part& outer : parts) {
        if (!is_dielectric(outer)) continue;
        pair_count += parts.size();
        if (pair_count > max_pairs) break;
        const bool is_absorbing = scene.materials[outer.material].absorption != vec3(0);
        for (const Part& inner : parts) {
            const bool is_opaque = !is_dielectric(inner);
            Nesting& found = is_opaque ? enclosed_object : nested_dielectric;
            if (found.inner == nullptr && (!is_opaque || is_absorbing) && is_inside(inner.bounds, outer.bounds))
                found = {&inner, &outer};
        }
    }

    std::vector<std::string> warnings;
    const auto warn = [&](const Nesting& found, const std::string& relation, const std::string& consequence) {
        if (found.inner == nullptr) return;
        warnings.push_back(scene.mesh_of(found.inner->instance).file + ": " + relation + " of " +
                           scene.mesh_of(found.outer->instance).file + ": " + consequence);
    };
    warn(nested_dielectric, "a dielectric may lie inside the dielectric",
         "each is computed as if air surrounded it, so light bends by Ni against 1 between them, too");
    warn(enclosed_object, "an opaque object may lie inside the absorbing glass",
         "Tf acts only where a ray arrives at the glass's surface from within, so light does not fade on its way to the object");
    const auto is_leaky = [](const Body& body) { return !body.is_open && body.open_edges > 0; };
    if (const auto leaky = std::ranges::find_if(bodies, is_leaky); leaky != bodies.end()) {
        size_t count = 0;
        for (const Body& body : bodies) count += body.instance == leaky->instance ? body.open_edges : 0;
        warnings.push_back(scene.mesh_of(leaky->instance).file + ": its glass is not closed: " + std::to_string(count) +
                           " edges have one triangle, or join a front to a back; light that enters a single "
                           "sheet never leaves it and is divided by Ni²: give it a thickness");
    }
    return warnings;
}

std::vector<std::string> precision_warnings(const Scene& scene) {
    std::vector<std::string> warnings;
    check_texture_coordinates(scene, warnings);
    const std::string name = scene.file.string();
    if (!scene.instances.empty()) {
        const Bounds bounds = world_bounds(scene);
        const glm::dvec3 low(bounds.low), high(bounds.high), farthest = glm::max(glm::abs(low), glm::abs(high));
        const double part = start_distance(farthest) / glm::distance(low, high);
        if (part > 1e-3)
            warnings.push_back(name + ": it is so far from the origin that 32-bit coordinates blur " + to_text(100 * part) +
                               " % of its size; move it closer");
    }
    const double row = 2 * std::tan(glm::radians(0.5 * double{scene.camera.vertical_fov})) / scene.defaults.height;
    if (row < 10 * rounding)
        warnings.push_back(name + ": the field of view is so narrow that 32-bit directions are rounded to " +
                           to_text(rounding / row) + " of a pixel; move the camera closer");
    return warnings;
}

}  // namespace lab
