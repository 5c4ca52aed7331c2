// A path carries the surface that it has reached instead of a ray: a call scatters there and traces the next ray. So what
// light samples leave to a bounce is decided within the call.
#define PATH_REGENERATION
#include "light_probe_sampling.glsl"
#include "low_discrepancy.glsl"

struct Path {
    ShadingData s;  // x_k
    vec3 out_direction;
    vec3 radiance;
    vec3 throughput;
    float radiance_scale;
    uint path_length;
    bool goes_on;
};

// Traces a ray and adds what shines there. The densities of light samples count where the last surface has one.
void arrive(inout Path path, Ray ray, bool is_light_sampled, float bounce_density) {
    Hit hit;
    vec3 emission;
    float light_density = 0.0;
    bool is_hit = trace_ray(ray, NO_LIMIT, hit);
    if (is_hit) {
        path.s = get_shading_data(hit, ray.direction);
        path.out_direction = -ray.direction;
        path.throughput *= path.s.transmittance;
        emission = path.s.emission;
        if (is_light_sampled)
            light_density = to_solid_angle(path.s.light_density, hit.distance, dot(path.s.geometric_normal, path.out_direction));
    } else {
        emission = get_background_radiance(ray.direction);
        if (is_light_sampled) light_density = get_light_probe_density(ray.direction);
    }
    if (is_counted(path.path_length))
        path.radiance += path.radiance_scale * path.throughput * get_bounce_part(light_density, bounce_density) * emission;
    path.goes_on = is_hit && path.path_length < parameters.max_path_length && is_above_surface(path.s, path.out_direction);
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
    bool is_light_sampled = (LIGHT_SAMPLING || LIGHT_PROBE_SAMPLING) && !s.is_dielectric;
    if (is_light_sampled) {
        vec3 direct_light = sample_direct_light(s, path.out_direction, seed);
        if (is_counted(path.path_length + 1u)) path.radiance += path.radiance_scale * path.throughput * direct_light;
    }
    vec3 omega;
    float bounce_density = 0.0;
    if (s.is_dielectric) {
        omega = sample_dielectric(s, path.out_direction, seed);
        bool is_refracted = dot(s.normal, omega) < 0.0;
        if (is_refracted != (dot(s.geometric_normal, omega) < 0.0)) return false;
        if (is_refracted) path.radiance_scale /= s.relative_index * s.relative_index;
    } else {
        omega = sample_brdf(s, path.out_direction, seed);
        if (!is_above_surface(s, omega)) return false;
        float density = get_brdf_density(s, omega, path.out_direction);
        path.throughput *= get_pi_brdf(s, omega, path.out_direction) * (dot(s.normal, omega) / PI / density);
        if (BOUNCES_FIND_LIGHTS) bounce_density = density;
    }
    ++path.path_length;
    if (path.path_length >= parameters.roulette_start) {
        float survival_probability = min(max_component(path.throughput), parameters.survival_cap);
        if (!happens(survival_probability, seed)) return false;
        path.throughput /= survival_probability;
    }
    arrive(path, get_ray_from_surface(s, omega), is_light_sampled, bounce_density);
    return path.goes_on;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Path path = start_path(ray);
    while (extend_path(path, seed)) {
    }
    return path.radiance;
}
