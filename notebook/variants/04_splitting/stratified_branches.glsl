// Splitting with stratified branches: at the first hit branch b of s takes its azimuth from the b-th of s equal
// sectors, and its point on the light from the b-th of s strips of equal area. Over all branches together the numbers
// are still uniform, so the mean of the branches has the same expectation.
#include "02_cosine_sampling/sample_hemisphere.glsl"

// Direct light by one point, for u uniform in [0,1)² on the chosen triangle.
vec3 reflect_light(ShadingData s, vec3 out_direction, vec2 u, inout uvec2 seed) {
    LightTriangle light = choose_light_triangle(seed);
    float root = sqrt(u.x);
    LightPoint y = get_light_point(light, vec2(root * (1.0 - u.y), root * u.y));
    vec3 to_light = y.position - s.position;
    float squared_distance = dot(to_light, to_light);
    vec3 omega = to_light / sqrt(squared_distance);
    float cos_light = -dot(y.normal, omega);
    if (cos_light <= 0.0 || !is_above_surface(s, omega)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);
    vec3 brdf = get_brdf(s, omega);
    return brdf * y.emission * light.inverse_density * dot(s.normal, omega) * cos_light / squared_distance;
}

// Two numbers, at the first hit with the first of them in stratum `branch` of `count`, later anywhere.
vec2 get_stratified_numbers(uint k, uint branch, uint count, inout uvec2 seed) {
    vec2 u = get_random_numbers(seed);
    if (k == 1u) u.x = min((float(branch) + u.x) / float(count), 0.9999999);
    return u;
}

vec3 follow_branch(uint branch, ShadingData s, vec3 out_direction, inout uvec2 seed) {
    uint count = parameters.splitting_factor;
    vec3 light = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint k = 1u; k <= parameters.max_path_length; ++k) {
        if (!is_above_surface(s, out_direction)) return light;
        if (STRATEGY != STRATEGY_BOUNCES) {
            vec2 point_numbers = get_stratified_numbers(k, branch, count, seed);
            vec3 direct_light = reflect_light(s, out_direction, point_numbers, seed);
            if (is_counted(k)) light += throughput * direct_light;
            bool only_lights_are_left = k == parameters.max_path_length && !HAS_BACKGROUND;
            if (only_lights_are_left) return light;
        }
        // sample_hemisphere() takes the azimuth from the first number.
        vec2 direction_numbers = get_stratified_numbers(k, branch, count, seed);
        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(direction_numbers);
        if (!is_above_surface(s, omega)) return light;
        throughput *= PI * get_brdf(s, omega);

        Hit hit;
        if (!trace_ray(get_ray_from_surface(s, omega), NO_LIMIT, hit)) {
            return is_counted(k) ? light + throughput * get_background_radiance(omega) : light;
        }
        s = get_shading_data(hit, omega);
        out_direction = -omega;
        if (STRATEGY == STRATEGY_BOUNCES && is_counted(k)) light += throughput * s.emission;
    }
    return light;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 branch_sum = vec3(0.0);
    for (uint branch = 0u; branch < parameters.splitting_factor; ++branch)
        branch_sum += follow_branch(branch, s, -ray.direction, seed);
    vec3 emission = is_counted(0u) ? s.emission : vec3(0.0);
    return emission + branch_sum / float(parameters.splitting_factor);
}
