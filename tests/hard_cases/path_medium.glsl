// Follows the paths of chapter 13, and compares the medium of each with what the solid angles of all bodies say in the middle of its
// rays: how many differ, and of how many.
#define path_trace unused_path_trace
#include "observed.glsl"
#undef path_trace

// The smallest body around a point. The triangles of the second instance's mesh start at SECOND_MESH.
uint get_medium_at(vec3 point) {
    for (uint body = uint(media.length()) - 1u; body > 0u; --body) {
        float sum = 0.0;
        for (uint i = 0u; i < uint(triangles.length()); ++i) {
            Boundary boundary = get_boundary(i < SECOND_MESH ? 0u : 1u, i);
            if (boundary.kind == BOUNDARY_NONE || boundary.body != body) continue;
            vec3 a = positions[triangles[i].x] - point, b = positions[triangles[i].y] - point, c = positions[triangles[i].z] - point;
            float la = length(a), lb = length(b), lc = length(c);
            sum += 2.0 * atan(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
        }
        if (abs(sum) > 2.0 * PI) return body;
    }
    return 0u;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Path path = start_path(ray);
    float wrong = 0.0, all = 0.0;
    for (uint i = 0u; i < 12u; ++i) {
        Hit hit;
        // Shorter rays may be those between two surfaces that touch.
        if (trace_ray(path.ray, NO_LIMIT, hit) && hit.distance > 0.01) {
            all += 1.0;
            if (get_medium_at(path.ray.origin + 0.5 * hit.distance * path.ray.direction) != path.medium) wrong += 1.0;
        }
        if (!extend_path(path, seed)) break;
    }
    return vec3(wrong, all, 0.0);
}
