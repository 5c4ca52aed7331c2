// How surfaces scatter light. Each file in world/materials/ evaluates and samples one material.
#include "world/materials/phong.glsl"

// The result of sampling a material: the direction ω_k of a bounce and what its path needs to know about it.
struct BsdfSample {
    vec3 direction;         // ω_k, unit length
    vec3 weight;            // ρ |n·ω_k| over the density, per colour channel; 0 where no light leaves into ω_k
    float density;          // of ω_k with respect to solid angle; 0 for a single direction
    float radiance_scale;   // the change of radiance at a refraction: 1/η², else 1
};

// The sum of the lobes of an opaque surface: the diffuse one, ρ = Kd / π, and whatever else the scene has.
vec3 get_lobes_brdf(ShadingData s, vec3 in_direction) {
    vec3 brdf = s.diffuse_albedo / PI;
#ifdef FEATURE_SPECULAR
    brdf += get_phong_brdf(s, in_direction);
#endif
    return brdf;
}

// The default get_brdf(), unless the chapter's folder brings its own materials in a file of this name.
#include "brdf.glsl"
