#include "error.h"
#include "parallel.h"
#include "tracing/bvh.h"

namespace lab {

// The triangle test multiplies two coordinates.
static constexpr float largest_coordinate = 1e18f;

uint64_t countable_triangles(const Scene& scene) {
    const uint64_t count = instanced_triangle_count(scene);
    if (count > max_triangle_count)
        throw UserError(scene.file.string() + ": its instances have " + std::to_string(count) +
                        " triangles together, more than 2^28 - 1; remove instances or use another backend");
    return count;
}

LargeArray<BvhTriangle> world_triangles(const Scene& scene) {
    LargeArray<BvhTriangle> triangles(countable_triangles(scene));
    size_t first = 0;  // of the instance
    for (uint32_t instance = 0; instance < scene.instances.size(); ++instance) {
        const glm::dmat4x3 object_to_world(scene.instances[instance].object_to_world);
        const auto world = [&](uint32_t position) {
            const vec3 result(object_to_world * glm::dvec4(scene.positions[position], 1));
            if (!glm::all(glm::lessThanEqual(glm::abs(result), vec3(largest_coordinate))))
                throw UserError(scene.file.string() + ": instance " + std::to_string(instance) +
                                " has coordinates beyond 1e18 in the world; scale it down");
            return result;
        };
        const Mesh& mesh = scene.mesh_of(instance);
        in_parallel(mesh.triangle_count, 1 << 14, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const auto triangle = static_cast<uint32_t>(mesh.first_triangle + i);
                const uvec3 vertices = scene.triangles[triangle];
                const mat3 rows =
                    glm::transpose(mat3(world(vertices.x), world(vertices.y), world(vertices.z)));
                triangles[first + i] = {rows[0], instance, rows[1], triangle, rows[2], 0};
            }
        });
        first += mesh.triangle_count;
    }
    return triangles;
}

}  // namespace lab
