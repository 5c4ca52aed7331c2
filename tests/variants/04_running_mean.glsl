// Splitting with a running mean of the branches, and light samples chosen by resampling: of two candidates one gets
// the shadow ray, with probability proportional to what it would bring.
#include "sampling.glsl"

struct Candidate {
    LightPoint y;
    vec3 light;   // f L_e times the geometry term over the density, without visibility
    float weight; // what decides
};

Candidate get_candidate(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    LightTriangle triangle = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    if (u.x + u.y >= 1.0) u = 1.0 - u.yx;  // folds the square along its diagonal
    Candidate candidate = Candidate(get_light_point(triangle, u), vec3(0.0), 0.0);
    vec3 path = candidate.y.position - s.position;
    float r = length(path);
    path /= r;
    float cos_light = dot(candidate.y.normal, -path);
    if (!is_above_surface(s, path) || !(cos_light > 0.0)) return candidate;
    vec3 brdf = get_pi_brdf(s, path, out_direction) / PI;
    float geometry = dot(s.normal, path) * cos_light / (r * r);
    candidate.light = brdf * geometry * triangle.inverse_density * candidate.y.emission;
    candidate.weight = candidate.light.r + candidate.light.g + candidate.light.b;
    return candidate;
}

// E = Σ_i P(i) light_i / (2 P(i)) = mean of both.
vec3 sample_lights(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    Candidate a = get_candidate(s, out_direction, seed);
    Candidate b = get_candidate(s, out_direction, seed);
    float sum = a.weight + b.weight;
    if (!(sum > 0.0)) return vec3(0.0);
    bool takes_a = get_random_numbers(seed).x * sum < a.weight;
    if (!takes_a) a = b;
    if (!(a.weight > 0.0)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, a.y.position_in_front), 1.0)) return vec3(0.0);
    return a.light * sum / (2.0 * a.weight);
}

vec3 trace_from(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    vec3 radiance = vec3(0.0), throughput = vec3(1.0);
    for (uint length_left = parameters.max_path_length; length_left > 0u; --length_left) {
        uint k = parameters.max_path_length - length_left + 1u;
        bool is_shown = is_counted(k);
        if (!is_above_surface(s, out_direction)) break;
        if (LIGHT_SAMPLING) {
            vec3 direct_light = sample_lights(s, out_direction, seed);
            if (is_shown) radiance += throughput * direct_light;
            if (length_left == 1u && !HAS_BACKGROUND) break;
        }
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) break;
        throughput *= get_pi_brdf(s, omega, out_direction);
        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            if (is_shown) radiance += throughput * get_background_radiance(omega);
            break;
        }
        s = get_shading_data(hit, omega);
        out_direction = -omega;
        if (!LIGHT_SAMPLING && is_shown) radiance += throughput * s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    // After n branches `mean` is the mean of n of them.
    vec3 mean = vec3(0.0);
    for (uint n = 1u; n <= parameters.splitting_factor; ++n) {
        vec3 branch = trace_from(s, -ray.direction, seed);
        mean += (branch - mean) / float(n);
    }
    return is_counted(0u) ? s.emission + mean : mean;
}
