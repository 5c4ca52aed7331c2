// Runs an estimator, a chapter's path_trace.glsl, at a single surface point: the first ray that it traces hits a made-up
// triangle, all others miss it and see a sky of radiance 1. So tests can check the estimator's own code direction by direction:
// the radiance that it returns is the weight of the direction that it has chosen.
#extension GL_EXT_scalar_block_layout : require
#define FEATURE_SKY
#define FEATURE_VERTEX_NORMALS
#include "interface.h"
#include "world/constants.glsl"
#include "world/random.glsl"
#include "world/frame.glsl"
#include "world/ray.glsl"

// In place of scene.glsl.
RenderParameters parameters;
vec3 positions[6];
vec3 normals[6];
uvec3 triangles[2] = {uvec3(0u, 1u, 2u), uvec3(3u, 4u, 5u)};  // the surface, and a light where a test needs one
uint triangle_materials[2] = {0u, 1u};
Material materials[2];
#ifdef FEATURE_MICROFACETS
Microfacets microfacets[2];
#endif

#include "world/light_probe.glsl"
#include "world/background.glsl"
#include "world/shading_data.glsl"
#include "world/materials.glsl"

// In place of a backend. The direction of the latest ray is kept.
vec3 traced_direction;
bool trace_ray(Ray ray, float t_max, out Hit hit) {
    ++ray_count;
    traced_direction = ray.direction;
    hit.instance = 0u;
    hit.triangle = 0u;
    hit.barycentrics = vec2(0.25);
    hit.distance = 1.0;
    return ray_count == 1u;
}

bool is_counted(uint path_length) { return true; }

// `max_path_length` is 1 but not a constant: with a constant, Mesa 25.0.7 for CPUs miscompiles the estimators' loop.
void set_surface(vec3 normal, Material material, uint max_path_length) {
    vec3 tangent = normalize(cross(normal, abs(normal.x) > 0.5 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
    vec3 corners[3] = {vec3(0.0), tangent, cross(normal, tangent)};
    for (int i = 0; i < 3; ++i) {
        positions[i] = corners[i];
        normals[i] = normal;
    }
    materials[0] = material;
    parameters.max_path_length = max_path_length;
    parameters.background = vec3(1.0);
    parameters.splitting_factor = 1u;
    parameters.roulette_start = 2u;
    parameters.survival_weight = 1.0;
}
