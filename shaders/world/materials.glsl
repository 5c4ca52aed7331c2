// What a surface does with light. Every material of world/materials/ evaluates and samples its part.
#include "world/materials/phong.glsl"

// What sampling a material gives: the direction ω_k of a bounce and what its path needs to know of it.
struct BsdfSample {
    vec3 direction;         // ω_k, unit length
    vec3 weight;            // ρ |n·ω_k| over its density; 0 where no light leaves into ω_k
    float density;          // of ω_k with respect to solid angle; 0 for a single direction
    bool is_single;         // whether the material scatters into single directions, which no light sample can meet
    float radiance_scale;   // the change of radiance at a refraction: 1/η², else 1
};

// get_brdf(), unless the chapter's folder has a file of this name: its materials.
#include "brdf.glsl"
