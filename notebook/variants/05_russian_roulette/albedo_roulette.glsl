// Russian roulette from the second bounce on, by the latest factor alone: a path survives with the probability with
// which the surface would have kept a photon. The throughput then stays what it was, apart from its colour.
#include "03_next_event_estimation/direct_light.glsl"

// Density cos θ / π: Shirley and Chiu's map of the square to the disk, lifted.
vec3 sample_lifted_disk(vec2 u) {
    vec2 a = 2.0 * u - 1.0;
    bool is_x_larger = abs(a.x) > abs(a.y);
    float radius = is_x_larger ? a.x : a.y;
    if (radius == 0.0) return vec3(0.0, 0.0, 1.0);
    float angle = is_x_larger ? 0.25 * PI * a.y / a.x : 0.5 * PI - 0.25 * PI * a.x / a.y;
    return vec3(radius * cos(angle), radius * sin(angle), sqrt(max(1.0 - radius * radius, 0.0)));
}

const uint FIRST_ROULETTE = 2u;

// The factor of a bounce with roulette: factor / q with probability q, else 0, so that its mean is the factor.
vec3 play_roulette(vec3 factor, inout uvec2 seed) {
    float q = min(max_component(factor) / parameters.survival_weight, parameters.survival_cap);
    float number = get_random_numbers(seed).x;
    return number < q ? factor / q : vec3(0.0);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData first = get_shading_data(hit, ray.direction);
    vec3 radiance = vec3(0.0);

    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch) {
        ShadingData s = first;
        vec3 out_direction = -ray.direction;
        vec3 throughput = vec3(1.0);
        uint path_length = 1u;
        while (path_length <= parameters.max_path_length && is_above_surface(s, out_direction)) {
            bool is_shown = is_counted(path_length);
            if (STRATEGY != STRATEGY_BOUNCES) {
                vec3 direct_light = sample_direct_light(s, seed);
                if (is_shown) radiance += throughput * direct_light;
            }
            if (STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && path_length == parameters.max_path_length) break;

            vec3 omega = get_shading_space(s.normal) * sample_lifted_disk(get_random_numbers(seed));
            if (!is_above_surface(s, omega)) break;
            vec3 factor = PI * get_brdf(s, omega);
            if (path_length >= FIRST_ROULETTE) factor = play_roulette(factor, seed);
            if (factor == vec3(0.0)) break;
            throughput *= factor;

            if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
                if (is_shown) radiance += throughput * get_background_radiance(omega);
                break;
            }
            s = get_shading_data(hit, omega);
            out_direction = -omega;
            if (STRATEGY == STRATEGY_BOUNCES && is_shown) radiance += throughput * s.emission;
            ++path_length;
        }
    }
    radiance /= float(parameters.splitting_factor);
    if (is_counted(0u)) radiance += first.emission;
    return radiance;
}
