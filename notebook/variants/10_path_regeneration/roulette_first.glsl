// A path's last decision at a bounce, Russian roulette, comes first in the next call. Bounces are counted down.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "06_dielectrics/dielectric.glsl"
#include "07_multiple_importance_sampling/sample_bsdf.glsl"
#include "choose_light.glsl"
#include "07_multiple_importance_sampling/weights.glsl"
#include "08_light_probes/light_probe_sampling.glsl"

struct Path {
    vec3 radiance;
    vec3 beta;    // product of all weights
    float scale;  // 1/η² for every medium entered
    Ray ray;
    uint bounces_left;
    float p_bounce;  // of the ray's direction; below 0: no light sample was taken where it starts
};

Path start_path(Ray ray) {
    Path path;
    path.radiance = vec3(0.0);
    path.beta = vec3(1.0);
    path.scale = 1.0;
    path.ray = ray;
    path.bounces_left = parameters.max_path_length;
    path.p_bounce = -1.0;
    return path;
}

// Adds what a bounce finds, weighted against light samples of this density.
void find(inout Path path, vec3 emission, float p_light) {
    if (!is_counted(parameters.max_path_length - path.bounces_left)) return;
    float part = path.p_bounce < 0.0 ? 1.0 : get_bounce_part(p_light, path.p_bounce);
    path.radiance += path.scale * part * path.beta * emission;
}

bool survives(inout Path path, inout uvec2 seed) {
    uint length = parameters.max_path_length - path.bounces_left;
    if (length == 0u || length < parameters.roulette_start) return true;
    float q = min(max(path.beta.r, max(path.beta.g, path.beta.b)) / parameters.survival_weight, parameters.survival_cap);
    path.beta /= q;
    return happens(q, seed);
}

bool extend_path(inout Path path, inout uvec2 seed) {
    if (!survives(path, seed)) return false;
    bool has_light_sample = path.p_bounce >= 0.0;
    Hit hit;
    if (!trace_ray(path.ray, NO_LIMIT, hit)) {
        find(path, get_background_radiance(path.ray.direction),
             has_light_sample ? get_background_density(path.ray.direction) : 0.0);
        return false;
    }
    ShadingData s = get_shading_data(hit, path.ray.direction);
    path.beta *= s.transmittance;
    find(path, s.emission,
         has_light_sample ? to_solid_angle(s.light_density, hit.distance, dot(s.geometric_normal, s.out_direction)) : 0.0);
    if (path.bounces_left == 0u || !is_above_surface(s, s.out_direction)) return false;
    --path.bounces_left;

    has_light_sample = STRATEGY != STRATEGY_BOUNCES && !s.is_dielectric;
    if (has_light_sample) {
        vec3 direct_light = sample_direct_light(s, seed);
        if (is_counted(parameters.max_path_length - path.bounces_left)) path.radiance += path.scale * path.beta * direct_light;
    }
    BsdfSample next = sample_bsdf(s, seed);
    if (next.weight == vec3(0.0)) return false;
    path.beta *= next.weight;
    path.scale *= next.radiance_scale;
    path.p_bounce = has_light_sample ? (STRATEGY == STRATEGY_LIGHT ? 0.0 : next.density) : -1.0;
    path.ray = get_ray_from_surface(s, next.direction);
    return true;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Path path = start_path(ray);
    while (extend_path(path, seed)) {
    }
    return path.radiance;
}
