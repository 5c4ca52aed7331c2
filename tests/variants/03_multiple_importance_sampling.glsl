// Light samples and bounces together, each weighted by the balance heuristic: w_light = p_light / (p_light + p_bounce)
// and w_bounce = 1 - w_light, so that whatever is counted is counted once.
#include "sampling.glsl"

#ifdef FEATURE_LIGHT_SAMPLING
// Lights are chosen by area times luminance, hence the density per area is luminance / (their sum over all lights).
float get_total_luminance() {
    LightTriangle first = light_triangles[0];
    vec3 emission = get_light_point(first, vec2(1.0 / 3.0)).emission;
    return dot(emission, vec3(0.2126, 0.7152, 0.0722)) * first.inverse_density;
}
#else
float get_total_luminance() { return 1.0; }
#endif

// Density with respect to solid angle with which a light sample finds a point of this emission.
float get_light_density(vec3 emission, float cos_light, float distance) {
    float density_per_area = dot(emission, vec3(0.2126, 0.7152, 0.0722)) / get_total_luminance();
    return density_per_area * distance * distance / cos_light;
}

// `is_alone`: no bounce will look for lights besides, so the sample counts in full.
vec3 sample_light(ShadingData s, vec3 out_direction, bool is_alone, inout uvec2 seed) {
    LightTriangle light = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    LightPoint y = get_light_point(light, vec2(1.0 - sqrt(u.x), sqrt(u.x) * u.y));
    vec3 to_light = y.position - s.position;
    float distance = length(to_light);
    vec3 omega = to_light / distance;
    float cos_light = dot(y.normal, -omega);
    float cos_surface = dot(s.normal, omega);
    if (!(cos_light > 0.0) || !is_above_surface(s, omega)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    float geometry = cos_surface * cos_light / (distance * distance);
    vec3 full = get_pi_brdf(s, omega, out_direction) / PI * geometry * light.inverse_density * y.emission;
    if (is_alone) return full;
    float p_light = get_light_density(y.emission, cos_light, distance);
    float p_bounce = cos_surface / PI;
    return full * p_light / (p_light + p_bounce);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    vec3 last_position = vec3(0.0);
    float p_bounce = 0.0;  // of the direction that led here; the camera's counts as infinite
    for (uint path_length = 0u;; ++path_length) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        vec3 out_direction = -ray.direction;
        float emission_weight = 1.0;
        if (LIGHT_SAMPLING && path_length > 0u && s.emission != vec3(0.0)) {
            float cos_light = dot(s.geometric_normal, out_direction);
            float p_light = get_light_density(s.emission, cos_light, length(s.position - last_position));
            emission_weight = p_bounce / (p_bounce + p_light);
        }
        if (is_counted(path_length)) radiance += emission_weight * throughput * s.emission;
        if (path_length == parameters.max_path_length || !is_above_surface(s, out_direction)) break;

        bool is_last = path_length + 1u == parameters.max_path_length && !HAS_BACKGROUND;
        if (LIGHT_SAMPLING) {
            vec3 direct_light = sample_light(s, out_direction, is_last, seed);
            if (is_counted(path_length + 1u)) radiance += throughput * direct_light;
            if (is_last) break;
        }
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) break;
        throughput *= get_pi_brdf(s, omega, out_direction);
        p_bounce = dot(s.normal, omega) / PI;
        last_position = s.position;
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
