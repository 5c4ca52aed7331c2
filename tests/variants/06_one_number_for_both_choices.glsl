// Dielectrics: reflection or refraction and the survival of the path are decided by the same random number. Given that
// u < F, u/F is uniform in [0,1), and given that u >= F, (u - F) / (1 - F) is.
#include "sampling.glsl"
#include "direct_light.glsl"

// A uniform number that answers several questions with given probabilities.
bool ask(inout float u, float probability) {
    bool answer = u < probability;
    u = answer ? u / probability : (u - probability) / max(1.0 - probability, 1e-7);
    u = clamp(u, 0.0, 0.9999999);
    return answer;
}

// Squared ratio of amplitudes for unpolarised light; g = η cos θ_t.
float get_reflected_share(float c, float g, float eta) {
    float s_polarised = (c - g) / (c + g);
    float p_polarised = (eta * eta * c - g) / (eta * eta * c + g);
    return 0.5 * dot(vec2(s_polarised, p_polarised), vec2(s_polarised, p_polarised));
}

struct Path {
    ShadingData s;
    vec3 to_origin;
    vec3 throughput;
    float medium_scale;
    bool is_emission_open;  // no light sample can have found what comes next
};

// One way from a dielectric. False if it leads to the wrong side of the triangle.
bool pass_dielectric(inout Path path, inout float u, out vec3 direction) {
    ShadingData s = path.s;
    float c = dot(s.normal, path.to_origin);
    float eta = s.relative_index;
    float g_squared = eta * eta - 1.0 + c * c;
    bool is_total = g_squared <= 0.0;
    float g = sqrt(max(g_squared, 0.0));
    if (is_total || ask(u, get_reflected_share(c, g, eta))) {
        direction = reflect(-path.to_origin, s.normal);
        return is_above_surface(s, direction);
    }
    direction = normalize((c - g) * s.normal - path.to_origin);
    path.medium_scale /= eta * eta;
    return dot(s.geometric_normal, direction) < 0.0 && dot(s.normal, direction) < 0.0;
}

vec3 trace_branch(ShadingData first, vec3 to_camera, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    Path path = Path(first, to_camera, first.transmittance, 1.0, false);
    uint path_length = 0u;
    while (path_length < parameters.max_path_length && is_above_surface(path.s, path.to_origin)) {
        ++path_length;
        bool is_shown = is_counted(path_length);
        path.is_emission_open = path.s.is_dielectric || !LIGHT_SAMPLING;
        if (!path.is_emission_open) {
            vec3 direct_light = sample_direct_light(path.s, path.to_origin, seed);
            if (is_shown) radiance += path.medium_scale * path.throughput * direct_light;
            if (path_length == parameters.max_path_length && !HAS_BACKGROUND) break;
        }

        vec2 u = get_random_numbers(seed);
        vec3 direction;
        if (path.s.is_dielectric) {
            if (!pass_dielectric(path, u.x, direction)) break;
        } else {
            direction = get_shading_space(path.s.normal) * sample_hemisphere(u);
            if (!is_above_surface(path.s, direction)) break;
            path.throughput *= get_pi_brdf(path.s, direction, path.to_origin);
            u = get_random_numbers(seed);
        }
        if (path_length >= parameters.roulette_start) {
            float survival_probability = min(max_component(path.throughput), parameters.survival_cap);
            if (!ask(u.x, survival_probability)) break;
            path.throughput /= survival_probability;
        }

        Hit hit;
        if (!trace_ray(get_ray_from_surface(path.s, direction), NO_LIMIT, hit)) {
            vec3 sky = get_background_radiance(direction);
            if (is_shown) radiance += path.medium_scale * path.throughput * sky;
            break;
        }
        path.s = get_shading_data(hit, direction);
        path.to_origin = -direction;
        path.throughput *= path.s.transmittance;
        vec3 emission = path.is_emission_open ? path.s.emission : vec3(0.0);
        if (is_shown) radiance += path.medium_scale * path.throughput * emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 radiance = is_counted(0u) ? s.transmittance * s.emission : vec3(0.0);
    float share = 1.0 / float(parameters.splitting_factor);
    for (uint i = parameters.splitting_factor; i > 0u; --i) radiance += share * trace_branch(s, -ray.direction, seed);
    return radiance;
}
