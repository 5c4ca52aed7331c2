// Next event estimation where a light's triangle is chosen in one of two ways: mostly by the table, now and then (share
// UNIFORM_SHARE) all triangles alike. The density of a point is that of both ways together; it must not matter which
// of them has chosen it.
#include "sampling.glsl"

const float UNIFORM_SHARE = 0.125;

struct LightChoice {
    LightTriangle light;
    float density;  // of each of its points with respect to area
};

#ifdef FEATURE_LIGHT_SAMPLING
LightChoice choose_light(inout uvec2 seed) {
    uint count = uint(light_triangles.length());
    LightTriangle light = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    if (u.x < UNIFORM_SHARE) light = light_triangles[min(uint(u.y * float(count)), count - 1u)];
    vec3 corner = get_light_point(light, vec2(0.0)).position;
    vec3 edge_1 = get_light_point(light, vec2(1.0, 0.0)).position - corner;
    vec3 edge_2 = get_light_point(light, vec2(0.0, 1.0)).position - corner;
    float area = 0.5 * length(cross(edge_1, edge_2));
    float density = (1.0 - UNIFORM_SHARE) / light.inverse_density + UNIFORM_SHARE / (float(count) * area);
    return LightChoice(light, density);
}
#else
LightChoice choose_light(inout uvec2 seed) { return LightChoice(choose_light_triangle(seed), 1.0); }
#endif

// Direct light towards out_direction. `omega` and the light's distance belong to one random point.
vec3 estimate_direct_light(ShadingData s, vec3 out_direction, inout uvec2 seed) {
    LightChoice choice = choose_light(seed);
    vec2 u = get_random_numbers(seed);
    // Uniform barycentric coordinates: the first vertex's weight is 1 - √u.
    float w_0 = 1.0 - sqrt(1.0 - u.x);
    float w_1 = (1.0 - w_0) * u.y;
    LightPoint y = get_light_point(choice.light, vec2(w_1, 1.0 - w_0 - w_1));

    vec3 offset = y.position - s.position;
    float squared_distance = dot(offset, offset);
    vec3 omega = normalize(offset);
    float cos_light = dot(-omega, y.normal);
    if (cos_light <= 0.0) return vec3(0.0);
    if (!is_above_surface(s, omega)) return vec3(0.0);

    // A ray of unit direction that ends in front of the light.
    Ray shadow_ray = get_ray_to_point(s, y.position_in_front);
    float reach = length(shadow_ray.direction);
    shadow_ray.direction /= reach;
    if (is_occluded(shadow_ray, reach)) return vec3(0.0);

    vec3 reflected = get_pi_brdf(s, omega, out_direction) / PI * dot(s.normal, omega) * y.emission;
    float solid_angle_per_area = cos_light / squared_distance;
    return reflected * solid_angle_per_area / choice.density;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    uint limit = parameters.max_path_length;
    for (uint bounces = 0u; bounces <= limit; ++bounces) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(bounces)) radiance += throughput * get_background_radiance(ray.direction);
            return radiance;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        vec3 out_direction = -ray.direction;
        bool has_been_sampled = LIGHT_SAMPLING && bounces > 0u;
        if (!has_been_sampled && is_counted(bounces)) radiance += throughput * s.emission;
        if (bounces == limit || !is_above_surface(s, out_direction)) return radiance;

        // The bounce is sampled before the light.
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (LIGHT_SAMPLING) {
            vec3 direct_light = estimate_direct_light(s, out_direction, seed);
            if (is_counted(bounces + 1u)) radiance += throughput * direct_light;
            bool is_sky_missing = HAS_BACKGROUND;
            if (bounces + 1u == limit && !is_sky_missing) return radiance;
        }
        if (!is_above_surface(s, omega)) return radiance;
        throughput *= get_pi_brdf(s, omega, out_direction);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
