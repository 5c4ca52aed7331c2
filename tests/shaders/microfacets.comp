#version 460
// Microfacets at a surface point, for the chapter that has them: BSDF and density for each pair of directions, and a sample.
#define FEATURE_MICROFACETS
#define FEATURE_DIELECTRICS
#include "observation/estimator_stub.glsl"
#include "world/lights.glsl"
bool is_occluded(Ray ray, float t_max) { return false; }
#include "path_trace.glsl"

struct Input {
    vec3 in_direction;
    vec3 out_direction;
};
struct Result {
    vec3 brdf;
    float density;
    uint carries_light;       // along in_direction
    vec3 sampled_direction;
    vec3 sampled_weight;
    float sampled_density;    // 0 if the sample was rejected
    float density_of_sample;  // by get_bsdf_density()
    float radiance_scale;
};

layout(scalar, binding = 0) writeonly buffer Results { Result results[]; };
layout(scalar, binding = 1) readonly buffer Inputs {
    Material material;
    Microfacets material_facets;
    uvec2 key;  // of the random start states
    Input inputs[];
};

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    set_surface(vec3(0.0, 0.0, 1.0), material, 1u);
    microfacets[0] = material_facets;
    Hit hit;
    trace_ray(Ray(inputs[i].out_direction, -inputs[i].out_direction), NO_LIMIT, hit);
    hit.material_class = material.refractive_index > 0.0 ? MATERIAL_CLASS_DIELECTRIC : MATERIAL_CLASS_DIFFUSE;
    ShadingData s = get_shading_data(hit, -inputs[i].out_direction);
    results[i].brdf = get_brdf(s, inputs[i].in_direction);
    results[i].density = get_bsdf_density(s, inputs[i].in_direction);
    results[i].carries_light = is_above_surface(s, inputs[i].in_direction) ? 1u : 0u;
    uvec2 seed = random_start_state(i, 0u, key);
    BsdfSample bounce = sample_bsdf(s, seed);
    results[i].sampled_direction = bounce.direction;
    results[i].sampled_weight = bounce.weight;
    results[i].sampled_density = bounce.weight == vec3(0.0) ? 0.0 : bounce.density;
    results[i].density_of_sample = get_bsdf_density(s, bounce.direction);
    results[i].radiance_scale = bounce.radiance_scale;
}
