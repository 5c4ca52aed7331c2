// Next event estimation in two passes: first the path's vertices are laid down, then each of them asks the lights.
// Ten vertices at a time, so that paths of any length fit.
#include "02_cosine_sampling/sample_hemisphere.glsl"

struct Vertex {
    ShadingData s;
    vec3 out_direction;
    vec3 throughput;  // up to here, without this vertex
};

const uint VERTICES = 10u;

// Unbiased estimate of the direct light, as an integral over solid angle: f cos θ L_e V / p, where the density per area
// p_A = 1 / inverse_density turns into p = p_A r² / cos θ'.
vec3 gather_direct_light(Vertex vertex, inout uvec2 seed) {
    LightTriangle light = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    // The smaller of two uniform numbers, and what is left of the larger: areas of the three parts of a triangle.
    vec2 weights = vec2(min(u.x, u.y), 1.0 - max(u.x, u.y));
    LightPoint y = get_light_point(light, weights);
    vec3 difference = y.position - vertex.s.position;
    float r = length(difference);
    vec3 omega = difference / r;
    float cos_light = -dot(y.normal, omega);
    bool is_lit = cos_light > 0.0 && is_above_surface(vertex.s, omega);
    if (!is_lit || is_occluded(get_ray_to_point(vertex.s, y.position_in_front), 1.0)) return vec3(0.0);
    float density = r * r / cos_light / light.inverse_density;
    float cos_surface = dot(vertex.s.normal, omega);
    return get_brdf(vertex.s, omega) * y.emission * cos_surface / density;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    uint path_length = 0u;
    bool goes_on = true;
    while (goes_on) {
        // First pass: hits, with their emission unless light samples cover it.
        Vertex vertices[VERTICES];
        uint first_length = path_length;
        uint count = 0u;
        while (goes_on && count < VERTICES) {
            goes_on = false;
            Hit hit;
            if (!trace_ray(ray, NO_LIMIT, hit)) {
                if (is_counted(path_length)) radiance += throughput * get_background_radiance(ray.direction);
                break;
            }
            ShadingData s = get_shading_data(hit, ray.direction);
            bool is_new = path_length == 0u || STRATEGY == STRATEGY_BOUNCES;
            if (is_new && is_counted(path_length)) radiance += throughput * s.emission;
            if (path_length == parameters.max_path_length || !is_above_surface(s, -ray.direction)) break;
            vertices[count] = Vertex(s, -ray.direction, throughput);
            ++count;
            ++path_length;
            // The last vertex only asks the lights. A sky is found by a ray.
            if (STRATEGY != STRATEGY_BOUNCES && !HAS_BACKGROUND && path_length == parameters.max_path_length) break;

            vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
            if (!is_above_surface(s, omega)) break;
            throughput *= PI * get_brdf(s, omega);
            ray = get_ray_from_surface(s, omega);
            goes_on = true;
        }
        // Second pass: light that arrives at vertex i has been reflected first_length + i + 1 times.
        if (STRATEGY == STRATEGY_BOUNCES) continue;
        for (uint i = 0u; i < count; ++i) {
            vec3 direct_light = gather_direct_light(vertices[i], seed);
            if (is_counted(first_length + i + 1u)) radiance += vertices[i].throughput * direct_light;
        }
    }
    return radiance;
}
