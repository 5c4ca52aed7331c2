#include "sample_hemisphere.glsl"

// f * cos / pdf, as always
vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 L = vec3(0.0), beta = vec3(1.0);
    for (uint depth = 0u; depth <= parameters.max_path_length; ++depth) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(depth)) L += beta * get_background_radiance(ray.direction);
            return L;
        }
        ShadingData isect = get_shading_data(hit, ray.direction);
        if (is_counted(depth)) L += beta * isect.emission;

        vec3 wi = get_shading_space(isect.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(isect, isect.out_direction) || !is_above_surface(isect, wi)) return L;
        float pdf = 1.0 / PI;  // the cosine of the density cancels
        beta *= get_brdf(isect, wi) * dot(isect.normal, wi) / pdf;
        ray = get_ray_from_surface(isect, wi);
    }
    return L;
}
