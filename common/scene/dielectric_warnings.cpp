#include "scene/dielectric_warnings.h"

#include <map>

#include "scene/features.h"

namespace lab {
namespace {

constexpr size_t max_triangles = 10'000'000, max_pairs = 10'000'000;

// The triangles of one material in one instance.
struct Part {
    uint32_t mesh;
    uint32_t material;
    Bounds bounds;  // world space
};

std::vector<Part> parts_of(const Scene& scene) {
    std::vector<Part> parts;
    size_t triangle_count = 0;
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const uint32_t mesh_index = scene.instance_meshes[i];
        const Mesh& mesh = scene.meshes[mesh_index];
        triangle_count += mesh.triangle_count;
        if (triangle_count > max_triangles) break;
        std::map<uint32_t, Bounds> bounds_of_material;
        for (uint32_t k = mesh.first_triangle; k < mesh.first_triangle + mesh.triangle_count; ++k) {
            Bounds& bounds = bounds_of_material[scene.triangle_materials[k]];
            for (int corner = 0; corner < 3; ++corner)
                bounds.grow(scene.instances[i].object_to_world *
                            glm::vec4(scene.positions[scene.triangles[k][corner]], 1));
        }
        for (const auto& [material, bounds] : bounds_of_material)
            parts.push_back({mesh_index, material, bounds});
    }
    return parts;
}

// A part whose box lies inside that of another.
struct Nesting {
    const Part* inner = nullptr;
    const Part* outer = nullptr;
};

bool is_inside(const Bounds& inner, const Bounds& outer) {
    return glm::all(glm::lessThan(outer.low, inner.low)) && glm::all(glm::lessThan(inner.high, outer.high));
}

}  // namespace

std::vector<std::string> dielectric_warnings(const Scene& scene) {
    if (!features_of(scene).dielectrics) return {};
    const std::vector<Part> parts = parts_of(scene);
    const auto material_of = [&](const Part& part) -> const Material& {
        return scene.materials[part.material];
    };
    const auto is_dielectric = [&](const Part& part) { return material_of(part).refractive_index > 0; };

    Nesting nested_dielectric, enclosed_object;  // the first of each kind
    size_t pair_count = 0;
    for (const Part& outer : parts) {
        if (!is_dielectric(outer)) continue;
        pair_count += parts.size();
        if (pair_count > max_pairs) break;
        const bool is_absorbing = material_of(outer).absorption != vec3(0);
        for (const Part& inner : parts) {
            if (!is_inside(inner.bounds, outer.bounds)) continue;
            if (!is_dielectric(inner) && !is_absorbing) continue;
            Nesting& found = is_dielectric(inner) ? nested_dielectric : enclosed_object;
            if (found.inner == nullptr) found = {&inner, &outer};
        }
    }

    std::vector<std::string> warnings;
    const auto warn = [&](const Nesting& found, const std::string& inner_kind, const std::string& outer_kind,
                          const std::string& consequence) {
        if (found.inner == nullptr) return;
        warnings.push_back(scene.meshes[found.inner->mesh].file + ": " + inner_kind + " may lie inside the " +
                           outer_kind + " of " + scene.meshes[found.outer->mesh].file + ": " + consequence);
    };
    warn(nested_dielectric, "a dielectric", "dielectric",
         "each is computed as if air surrounded it, so light bends by Ni against 1 between them, too");
    warn(enclosed_object, "an opaque object", "absorbing glass",
         "Tf acts only where a ray arrives at the glass's surface from within, so light does not fade on its "
         "way to the object");
    return warnings;
}

}  // namespace lab
