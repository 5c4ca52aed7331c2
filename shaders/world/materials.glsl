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

// The BRDF ρ(x, ω_i, ω_o) of an opaque surface, for unit directions that point away from it.
vec3 get_brdf(ShadingData s, vec3 in_direction) {
#ifdef FEATURE_SPECULAR
    return s.diffuse_albedo / PI + get_phong_brdf(s, in_direction);
#else
    return s.diffuse_albedo / PI;
#endif
}
