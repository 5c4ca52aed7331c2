// Dielectrics: where the camera sees glass, the first of several branches is the reflection, with weight F, and all
// others share the refraction, with weight 1 - F. Nothing is left to chance there. At all later glass, and where there
// is only one branch, one of the two ways is chosen with the probabilities F and 1 - F.
#include "02_cosine_sampling/sample_hemisphere.glsl"
#include "03_next_event_estimation/direct_light.glsl"

// Share of reflected light. The index is that beyond the surface over that before it; 1 where nothing can be refracted.
float get_reflectance(float cos_theta, float index) {
    float square = index * index - 1.0 + cos_theta * cos_theta;
    if (square <= 0.0) return 1.0;
    float g = sqrt(square);  // index · cos θ_t
    float a = (g - cos_theta) / (g + cos_theta);
    float b = (cos_theta * (g + cos_theta) - 1.0) / (cos_theta * (g - cos_theta) + 1.0);
    return 0.5 * a * a * (1.0 + b * b);
}

vec3 get_refracted(ShadingData s, vec3 out_direction) {
    return normalize(refract(-out_direction, s.normal, 1.0 / s.relative_index));
}

struct Branch {
    ShadingData s;
    vec3 out_direction;
    vec3 throughput;
    float scale;  // 1/n² of the medium
};

// Takes one of the two ways from glass. False if it passes the two normals on different sides.
bool leave_glass(inout Branch b, bool reflects, out vec3 direction) {
    direction = reflects ? reflect(-b.out_direction, b.s.normal) : get_refracted(b.s, b.out_direction);
    if (!reflects) b.scale /= b.s.relative_index * b.s.relative_index;
    float side = reflects ? 1.0 : -1.0;
    return side * dot(direction, b.s.normal) > 0.0 && side * dot(direction, b.s.geometric_normal) > 0.0;
}

// choice: 0 reflects at the first hit, 1 refracts, 2 leaves it to chance.
vec3 trace_branch(Branch b, uint choice, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    for (uint k = 1u; k <= parameters.max_path_length; ++k) {
        if (!is_above_surface(b.s, b.out_direction)) break;
        bool is_shown = is_counted(k);
        bool samples_lights = STRATEGY != STRATEGY_BOUNCES && !b.s.is_dielectric;
        vec3 omega;
        if (b.s.is_dielectric) {
            float reflectance = get_reflectance(dot(b.s.normal, b.out_direction), b.s.relative_index);
            bool reflects = get_random_numbers(seed).x < reflectance;
            if (k == 1u && choice < 2u) reflects = choice == 0u;
            if (!leave_glass(b, reflects, omega)) break;
        } else {
            if (samples_lights) {
                vec3 direct_light = sample_direct_light(b.s, seed);
                if (is_shown) radiance += b.scale * b.throughput * direct_light;
                if (k == parameters.max_path_length && !HAS_BACKGROUND) break;
            }
            omega = get_shading_space(b.s.normal) * sample_hemisphere(get_random_numbers(seed));
            if (!is_above_surface(b.s, omega)) break;
            b.throughput *= PI * get_brdf(b.s, omega);
        }
        if (k >= parameters.roulette_start) {
            float q = min(max_component(b.throughput) / parameters.survival_weight, parameters.survival_cap);
            if (get_random_numbers(seed).x >= q) break;
            b.throughput /= q;
        }
        Hit hit;
        if (!trace_ray(get_ray_from_surface(b.s, omega), NO_LIMIT, hit)) {
            if (is_shown) radiance += b.scale * b.throughput * get_background_radiance(omega);
            break;
        }
        b.s = get_shading_data(hit, omega);
        b.out_direction = -omega;
        b.throughput *= b.s.transmittance;
        if (!samples_lights && is_shown) radiance += b.scale * b.throughput * b.s.emission;
    }
    return radiance;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return is_counted(0u) ? get_background_radiance(ray.direction) : vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    Branch start = Branch(s, -ray.direction, s.transmittance, 1.0);
    vec3 radiance = is_counted(0u) ? s.transmittance * s.emission : vec3(0.0);

    uint count = parameters.splitting_factor;
    float reflectance = s.is_dielectric ? get_reflectance(dot(s.normal, -ray.direction), s.relative_index) : 1.0;
    bool takes_both = count > 1u && reflectance < 1.0;
    for (uint i = 0u; i < count; ++i) {
        float weight = 1.0 / float(count);
        if (takes_both) weight = i == 0u ? reflectance : (1.0 - reflectance) / float(count - 1u);
        uint choice = takes_both ? min(i, 1u) : 2u;
        radiance += weight * trace_branch(start, choice, seed);
    }
    return radiance;
}
