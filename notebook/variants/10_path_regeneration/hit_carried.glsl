// A path carries the surface point that it has reached instead of a ray: a call scatters there and traces the next ray. So the
// weight of a bounce against light samples is computed within the call.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "06_dielectrics/dielectric.glsl"
#include "07_multiple_importance_sampling/sample_bsdf.glsl"
#include "choose_light.glsl"
#include "07_multiple_importance_sampling/weights.glsl"
#include "08_light_probes/light_probe_sampling.glsl"

struct Path {
    ShadingData s;  // x_k
    vec3 radiance;
    vec3 throughput;
    float radiance_scale;
    uint path_length;
    bool goes_on;
};

// Traces a ray and adds the emission that it meets. Light samples' densities count if the last surface took one.
void arrive(inout Path path, Ray ray, bool is_light_sampled, float bounce_density) {
    Hit hit;
    vec3 emission;
    float light_density = 0.0;
    bool is_hit = trace_ray(ray, NO_LIMIT, hit);
    if (is_hit) {
        path.s = get_shading_data(hit, ray.direction);
        path.throughput *= path.s.transmittance;
        emission = path.s.emission;
        if (is_light_sampled)
            light_density = to_solid_angle(path.s.light_density, hit.distance, dot(path.s.geometric_normal, path.s.out_direction));
    } else {
        emission = get_background_radiance(ray.direction);
        if (is_light_sampled) light_density = get_background_density(ray.direction);
    }
    if (is_counted(path.path_length))
        path.radiance += path.radiance_scale * path.throughput * get_bounce_part(light_density, bounce_density) * emission;
    path.goes_on = is_hit && path.path_length < parameters.max_path_length && is_above_surface(path.s, path.s.out_direction);
}

Path start_path(Ray ray) {
    Path path;
    path.radiance = vec3(0.0);
    path.throughput = vec3(1.0);
    path.radiance_scale = 1.0;
    path.path_length = 0u;
    arrive(path, ray, false, 0.0);
    return path;
}

bool extend_path(inout Path path, inout uvec2 seed) {
    if (!path.goes_on) return false;
    ShadingData s = path.s;
    bool is_light_sampled = STRATEGY != STRATEGY_BOUNCES && !s.is_dielectric;
    if (is_light_sampled) {
        vec3 direct_light = sample_direct_light(s, seed);
        if (is_counted(path.path_length + 1u)) path.radiance += path.radiance_scale * path.throughput * direct_light;
    }
    BsdfSample next = sample_bsdf(s, seed);
    if (next.weight == vec3(0.0)) return false;
    path.throughput *= next.weight;
    path.radiance_scale *= next.radiance_scale;
    float bounce_density = STRATEGY == STRATEGY_LIGHT ? 0.0 : next.density;
    ++path.path_length;
    if (path.path_length >= parameters.roulette_start) {
        float survival_probability = min(max_component(path.throughput) / parameters.survival_weight, parameters.survival_cap);
        if (!happens(survival_probability, seed)) return false;
        path.throughput /= survival_probability;
    }
    arrive(path, get_ray_from_surface(s, next.direction), is_light_sampled, bounce_density);
    return path.goes_on;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Path path = start_path(ray);
    while (extend_path(path, seed)) {
    }
    return path.radiance;
}
