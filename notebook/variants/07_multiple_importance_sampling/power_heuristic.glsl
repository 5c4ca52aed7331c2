// The power heuristic: weights proportional to the squares of the densities. Both are written with a quotient of densities, q =
// the other strategy's over one's own: 1 / (1 + q²).
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "06_dielectrics/dielectric.glsl"
#include "sample_bsdf.glsl"

float get_weight(float own, float other) {
    if (other == 0.0) return 1.0;
    float q = other / own;
    return own > 0.0 ? 1.0 / (1.0 + q * q) : 0.0;
}

struct Vertex {
    ShadingData s;
    vec3 to_eye;
};

// Density with respect to solid angle of a point on a light, seen under this angle at this distance.
float get_light_density(float per_area, float squared_distance, float cosine) {
    return per_area * squared_distance / cosine;
}

vec3 gather_light(Vertex v, inout uvec2 seed) {
    LightTriangle triangle = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    float root = sqrt(1.0 - u.x);
    LightPoint y = get_light_point(triangle, vec2(1.0 - root, u.y * root));
    vec3 difference = y.position - v.s.position;
    float squared_distance = dot(difference, difference);
    vec3 omega = difference / sqrt(squared_distance);
    float cosine = -dot(y.normal, omega);
    if (!(cosine > 0.0) || !is_above_surface(v.s, omega)) return vec3(0.0);
    float p_light = get_light_density(1.0 / triangle.inverse_density, squared_distance, cosine);
    float p_bounce = STRATEGY != STRATEGY_LIGHT ? get_bsdf_density(v.s, omega) : 0.0;
    vec3 brdf_cosine = get_brdf(v.s, omega) * dot(v.s.normal, omega);
    vec3 found = get_weight(p_light, p_bounce) * brdf_cosine / p_light * y.emission;
    return is_occluded(get_ray_to_point(v.s, y.position_in_front), 1.0) ? vec3(0.0) : found;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 sum = vec3(0.0), beta = vec3(1.0);
    float scale = 1.0, p_bounce = 0.0;
    bool shares = false;  // whether the light that comes next is shared with a light sample
    for (uint bounces = 0u;; ++bounces) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(bounces)) sum += scale * beta * get_background_radiance(ray.direction);
            return sum;
        }
        Vertex v = Vertex(get_shading_data(hit, ray.direction), -ray.direction);
        beta *= v.s.transmittance;
        float p_light = 0.0;
        if (shares && v.s.light_density > 0.0)
            p_light = get_light_density(v.s.light_density, hit.distance * hit.distance, dot(v.s.geometric_normal, v.to_eye));
        float weight = p_light > 0.0 ? get_weight(p_bounce, p_light) : 1.0;
        if (is_counted(bounces)) sum += scale * weight * beta * v.s.emission;
        if (bounces == parameters.max_path_length || !is_above_surface(v.s, v.to_eye)) return sum;

        shares = STRATEGY != STRATEGY_BOUNCES;
        if (v.s.is_dielectric) shares = false;
        if (shares && is_counted(bounces + 1u)) sum += scale * beta * gather_light(v, seed);
        BsdfSample next = sample_bsdf(v.s, seed);
        if (next.weight == vec3(0.0)) return sum;
        beta *= next.weight;
        scale *= next.radiance_scale;
        p_bounce = STRATEGY != STRATEGY_LIGHT ? next.density : 0.0;
        if (bounces + 1u >= parameters.roulette_start) {
            float q = min(max_component(beta) / parameters.survival_weight, parameters.survival_cap);
            if (!happens(q, seed)) return sum;
            beta /= q;
        }
        ray = get_ray_from_surface(v.s, next.direction);
    }
}
