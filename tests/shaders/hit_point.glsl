// Replaces a chapter's estimator: outputs numbers about a camera ray's hit. The maximal path length selects which, so that the
// same code traces the same ray for all of them.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return vec3(-1.0);
    SurfacePoint point = get_surface_point(hit);
    if (parameters.max_path_length == 0u) return ray.direction;
    if (parameters.max_path_length == 1u) return point.position;
    return vec3(hit.instance, hit.triangle, point.offset);
}
