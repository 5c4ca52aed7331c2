#include "sample_hemisphere.glsl"

// Tangent frame around n.
mat3 make_frame(vec3 n) {
    vec3 up = abs(n.y) < 0.999 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 t = cross(up, n);
    vec3 b = cross(n, t);
    return mat3(t, b, n);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    uint k = 0u;
    do {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(k)) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(k)) radiance += throughput * s.emission;
        if (k == parameters.max_path_length) break;

        vec3 omega = normalize(make_frame(s.normal) * sample_hemisphere(get_random_numbers(seed)));
        if (!is_above_surface(s, s.out_direction) || !is_above_surface(s, omega)) break;
        throughput *= PI * get_brdf(s, omega);
        ray = get_ray_from_surface(s, omega);
    } while (++k <= parameters.max_path_length);
    return radiance;
}
