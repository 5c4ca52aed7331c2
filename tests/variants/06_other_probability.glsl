// Dielectrics where reflection is chosen with another probability than F, and the weights F/P and (1-F)/(1-P) make up
// for it: a little more of the rare choice. The factor n² of radiance is kept apart: what a path finds is divided by
// the square of the index of the medium in which it is found.
#include "sampling.glsl"
#include "direct_light.glsl"

const float EVENLY = 0.1;  // share in which both are chosen alike

struct Bounce {
    vec3 direction;
    vec3 weight;      // 0: the path ends
    float index;      // passed through: relative refractive index, else 1
};

Bounce bounce_off_glass(ShadingData s, vec3 out_direction, float u) {
    Bounce bounce = Bounce(reflect(-out_direction, s.normal), vec3(1.0), 1.0);
    float eta = s.relative_index;
    float cos_i = dot(s.normal, out_direction);
    float cos_t_squared = 1.0 - (1.0 - cos_i * cos_i) / (eta * eta);
    if (cos_t_squared > 0.0) {
        float cos_t = sqrt(cos_t_squared);
        float parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        float perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        float F = 0.5 * (parallel * parallel + perpendicular * perpendicular);
        float P = mix(F, 0.5, EVENLY);
        bool reflects = u < P;
        bounce.weight = vec3(reflects ? F / P : (1.0 - F) / (1.0 - P));
        if (!reflects) {
            bounce.direction = normalize((cos_i / eta - cos_t) * s.normal - out_direction / eta);
            bounce.index = eta;
        }
    }
    bool is_up = dot(bounce.direction, s.normal) > 0.0;
    if (is_up != (dot(bounce.direction, s.geometric_normal) > 0.0)) bounce.weight = vec3(0.0);
    return bounce;
}

Bounce bounce_off_surface(ShadingData s, vec3 out_direction, vec2 u) {
    vec3 direction = get_shading_space(s.normal) * sample_hemisphere(u);
    bool is_valid = is_above_surface(s, direction);
    return Bounce(direction, is_valid ? get_pi_brdf(s, direction, out_direction) : vec3(0.0), 1.0);
}

vec3 trace_branch(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    vec3 radiance = vec3(0.0), throughput = s.transmittance;
    float index = 1.0;
    uint k = 1u;
    while (k <= parameters.max_path_length && is_above_surface(s, out_direction)) {
        bool asks_lights = LIGHT_SAMPLING && !s.is_dielectric;
        vec3 found = vec3(0.0);  // after k bounces, not yet divided by the index
        if (asks_lights) found += throughput * sample_direct_light(s, out_direction, seed);

        bool goes_on = !asks_lights || HAS_BACKGROUND || k < parameters.max_path_length;
        float found_index = index;
        if (goes_on) {
            vec2 u = get_random_numbers(seed);
            Bounce bounce;
            if (s.is_dielectric) bounce = bounce_off_glass(s, out_direction, u.y);
            else bounce = bounce_off_surface(s, out_direction, u);
            throughput *= bounce.weight;
            index *= bounce.index;
            found_index = index;  // at glass nothing has been found before
            goes_on = throughput != vec3(0.0);
            if (goes_on && k >= parameters.roulette_start) {
                float survival = min(max_component(throughput), parameters.survival_cap);
                goes_on = get_random_numbers(seed).x < survival;
                throughput /= survival;
            }
            if (goes_on) {
                Hit hit;
                goes_on = trace_ray(get_ray_from_surface(s, bounce.direction), NO_LIMIT, hit);
                if (goes_on) {
                    s = get_shading_data(hit, bounce.direction);
                    throughput *= s.transmittance;
                    out_direction = -bounce.direction;
                    if (!asks_lights) found += throughput * s.emission;
                } else {
                    found += throughput * get_background_radiance(bounce.direction);
                }
            }
        }
        if (is_counted(k)) radiance += found / (found_index * found_index);
        if (!goes_on) break;
        ++k;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.transmittance * s.emission : vec3(0.0);
    for (uint branch = 1u; branch <= parameters.splitting_factor; ++branch)
        radiance += trace_branch(s, -ray.direction, seed) / float(parameters.splitting_factor);
    return radiance;
}
