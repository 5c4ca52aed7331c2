#version 460
// For the backend `native`: looks up the corners of all triangles once, so that get_surface_point() only interpolates them. A thread
// fills the table's entry for a triangle of the tree.
#include "interface.h"
#include "world/scene.glsl"
#include "world/constants.glsl"
#include "world/frame.glsl"
#include "world/ray.glsl"
#include "world/shading_data.glsl"
#include "engine/trace_ray/world_triangles.h"

// As common/tracing/bvh.h has it: three rows a triangle, for x, y and z of the corners; the first two hold instance and triangle.
struct BvhRow {
    vec3 corners;
    uint id;
};
layout(scalar, set = 0, binding = BINDING_BVH_TRIANGLES) readonly buffer BvhTriangles { BvhRow rows[]; };
layout(scalar, set = 0, binding = BINDING_WORLD_TRIANGLES) writeonly buffer WorldTriangles { WorldTriangle world_triangles[]; };

layout(local_size_x = 64) in;

void main() {
    uint i = gl_WorkGroupID.x * 64u + gl_LocalInvocationIndex;
    if (i >= uint(world_triangles.length())) return;
    BvhRow x = rows[3u * i], y = rows[3u * i + 1u], z = rows[3u * i + 2u];
    world_triangles[i].corners = transpose(mat3(x.corners, y.corners, z.corners));
    Hit hit;
    hit.instance = x.id;
    hit.triangle = y.id;
    const vec2 BARYCENTRICS[3] = vec2[3](vec2(0.0), vec2(1.0, 0.0), vec2(0.0, 1.0));
    for (int corner = 0; corner < 3; ++corner) {
        hit.barycentrics = BARYCENTRICS[corner];
        SurfacePoint point = get_surface_point(hit);
        world_triangles[i].normal = point.geometric_normal;
        world_triangles[i].offsets[corner] = point.offset;
    }
}
