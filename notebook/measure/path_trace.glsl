// The benchmark's estimator: next event estimation on one rectangular light and Russian roulette.
#include "ceiling_light.h"

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint k = 0u;; ++k) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) break;
        ShadingData s = get_shading_data(hit, ray.direction);
        if (k == 0u) radiance += s.emission;
        if (k == parameters.max_path_length) break;

        vec2 u = get_random_numbers(seed);
        throughput *= s.diffuse_albedo;
        vec3 to_light = LIGHT_CORNER + u.x * LIGHT_EDGE_1 + u.y * LIGHT_EDGE_2 - s.position;
        float cosines = max(0.0, dot(s.normal, to_light)) * max(0.0, -dot(LIGHT_NORMAL, to_light));
        // The light itself must not cast a shadow.
        if (cosines > 0.0 && !is_occluded(get_ray_from_surface(s, to_light), 0.9999)) {
            float squared_distance = dot(to_light, to_light);
            float form_factor = cosines * LIGHT_AREA / (PI * squared_distance * squared_distance);
            radiance += throughput * LIGHT_RADIANCE * form_factor;
        }

        float survival = min(SURVIVAL_CAP, max(throughput.r, max(throughput.g, throughput.b)));
        if (get_random_numbers(seed).x >= survival) break;
        throughput /= survival;
        u = get_random_numbers(seed);
        float radius = sqrt(u.x), angle = 2.0 * PI * u.y;
        vec3 direction = vec3(radius * cos(angle), radius * sin(angle), sqrt(1.0 - u.x));
        ray = get_ray_from_surface(s, get_shading_space(s.normal) * direction);
    }
    return radiance;
}
