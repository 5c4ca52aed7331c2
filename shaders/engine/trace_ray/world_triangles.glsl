// get_surface_point() of the backend `native`, which has this file in place of world/surface_point.glsl: world_triangles.comp has
// looked up the vertices of all triangles and put them into a table.
#include "engine/trace_ray/world_triangles.h"

layout(scalar, set = 0, binding = BINDING_WORLD_TRIANGLES) readonly buffer WorldTriangles {
    WorldTriangle world_triangles[];
};
layout(scalar, set = 0, binding = BINDING_FIRST_WORLD_TRIANGLES) readonly buffer FirstWorldTriangles {
    uint first_world_triangles[];  // per instance: the index of triangle 0, if it had that
};

// Interpolates the vertices of the hit triangle. The normal points to the front.
SurfacePoint get_surface_point(Hit hit) {
    WorldTriangle triangle = world_triangles[first_world_triangles[hit.instance] + hit.triangle];
    vec3 w = get_vertex_weights(hit);
    return SurfacePoint(triangle.corners * w, triangle.normal, dot(triangle.offsets, w));
}
