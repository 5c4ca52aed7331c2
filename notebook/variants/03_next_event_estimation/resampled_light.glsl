// Next event estimation with resampling (Talbot, Cline and Egbert 2005): of three candidates y_i with density p_i one
// is kept with probability proportional to w_i = t(y_i) / p_i, where t is the luminance of its contribution if nothing
// is in between. The estimate f(y) / t(y) · mean(w_i) has the right expectation, and needs a single shadow ray.
#include "02_cosine_sampling/sample_hemisphere.glsl"

const uint CANDIDATES = 3u;

float get_luminance(vec3 colour) { return dot(colour, vec3(0.2126, 0.7152, 0.0722)); }

// Contribution of a point without visibility, per area of the light.
vec3 get_unshadowed(ShadingData s, vec3 out_direction, LightPoint y) {
    vec3 to_light = y.position - s.position;
    float squared_distance = dot(to_light, to_light);
    vec3 omega = to_light / sqrt(squared_distance);
    float cos_light = dot(y.normal, -omega);
    if (!(cos_light > 0.0)) return vec3(0.0);
    if (!is_above_surface(s, omega)) return vec3(0.0);
    float cos_surface = dot(s.normal, omega);
    return get_brdf(s, omega) * y.emission * cos_surface * cos_light / squared_distance;
}

vec3 get_direct_light(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    LightPoint kept;
    vec3 kept_light = vec3(0.0);
    float kept_target = 0.0;
    float weight_sum = 0.0;
    for (uint i = 0u; i < CANDIDATES; ++i) {
        LightTriangle light = choose_light_triangle(seed);
        vec2 u = get_random_numbers(seed);
        float root = sqrt(u.x);
        LightPoint y = get_light_point(light, vec2(root * u.y, root * (1.0 - u.y)));
        vec3 unshadowed = get_unshadowed(s, out_direction, y);
        float target = get_luminance(unshadowed);
        float weight = target * light.inverse_density;
        weight_sum += weight;
        // Reservoir: the newcomer replaces the kept one with probability weight / sum of all so far.
        if (get_random_numbers(seed).x * weight_sum < weight) {
            kept = y;
            kept_light = unshadowed;
            kept_target = target;
        }
    }
    if (!(kept_target > 0.0)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, kept.position_in_front), 1.0)) return vec3(0.0);
    return kept_light / kept_target * (weight_sum / float(CANDIDATES));
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.emission : vec3(0.0);
    vec3 throughput = vec3(1.0);
    vec3 out_direction = -ray.direction;
    for (uint k = 1u; k <= parameters.max_path_length && is_above_surface(s, out_direction); ++k) {
        bool shows_length = is_counted(k);
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec3 direct = get_direct_light(s, out_direction, seed);
            if (shows_length) radiance += throughput * direct;
        }
        bool needs_ray = STRATEGY == STRATEGY_BOUNCES || HAS_BACKGROUND || k < parameters.max_path_length;
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!needs_ray || !is_above_surface(s, omega)) break;
        throughput *= PI * get_brdf(s, omega);

        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            if (shows_length) radiance += throughput * get_background_radiance(omega);
            break;
        }
        s = get_shading_data(hit, omega);
        out_direction = -omega;
        if (STRATEGY == STRATEGY_BOUNCES && shows_length) radiance += throughput * s.emission;
    }
    return radiance;
}
