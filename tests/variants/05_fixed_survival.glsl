// Russian roulette with one survival probability for all: 2/3, whatever the path carries. It may not be below the
// square of the albedo, or the weights 1/q of long paths would outgrow what the surfaces take away.
#include "sampling.glsl"

const float SURVIVAL = 2.0 / 3.0;

// Light of the lamps, as an integral over their area; the point by folding the unit square.
vec3 sample_lamps(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    LightTriangle lamp = choose_light_triangle(seed);
    vec2 w = get_random_numbers(seed);
    w = w.x > 1.0 - w.y ? 1.0 - w : w;
    LightPoint y = get_light_point(lamp, w);
    vec3 to_lamp = y.position - s.position;
    float squared = dot(to_lamp, to_lamp);
    vec3 omega = to_lamp * inversesqrt(squared);
    float cos_lamp = -dot(omega, y.normal);
    if (!is_above_surface(s, omega) || cos_lamp <= 0.0) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);
    float cos_surface = dot(omega, s.normal);
    vec3 irradiance = y.emission * cos_surface * cos_lamp / squared * lamp.inverse_density;
    return irradiance * get_pi_brdf(s, omega, out_direction) / PI;
}

// One path from the first hit, with the weight it has there.
vec3 trace_branch(ShadingData s, vec3 out_direction, float weight, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(weight);
    float q = min(SURVIVAL, parameters.survival_cap);
    for (uint bounce = 1u; bounce <= parameters.max_path_length; ++bounce) {
        if (!is_above_surface(s, out_direction)) return radiance;
        bool is_shown = is_counted(bounce);
        if (LIGHT_SAMPLING) {
            vec3 lamps = sample_lamps(s, out_direction, seed);
            if (is_shown) radiance += throughput * lamps;
        }
        bool is_final = bounce == parameters.max_path_length;
        if (is_final && LIGHT_SAMPLING && !HAS_BACKGROUND) return radiance;

        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) return radiance;
        throughput *= get_pi_brdf(s, omega, out_direction);
        if (throughput == vec3(0.0)) return radiance;
        if (bounce >= parameters.roulette_start) {
            if (get_random_numbers(seed).x >= q) return radiance;
            throughput /= q;
        }

        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            if (is_shown) radiance += throughput * get_background_radiance(omega);
            return radiance;
        }
        s = get_shading_data(hit, omega);
        out_direction = -omega;
        if (is_shown && !LIGHT_SAMPLING) radiance += throughput * s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);
    uint branches = parameters.splitting_factor;
    while (branches-- > 0u)
        radiance += trace_branch(s, -ray.direction, 1.0 / float(parameters.splitting_factor), seed);
    return radiance;
}
