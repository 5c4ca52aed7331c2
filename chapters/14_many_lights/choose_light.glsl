// Three ways to choose an emissive triangle.
const uint CHOOSES_BY_TREE = 0u;    // a LIGHT_CHOICE: by the tree
const uint CHOOSES_BY_POWER = 1u;   // a LIGHT_CHOICE: by its power, as in earlier chapters
const uint CHOOSES_UNIFORMLY = 2u;  // a LIGHT_CHOICE: all alike
// How light samples choose: one of the constants above, which --light-choice chooses.
#ifndef LIGHT_CHOICE
#define LIGHT_CHOICE CHOOSES_BY_TREE
#endif

// The point x_k at which light arrives. Its light sample depends on where it is, and so does the weight of the bounce that follows.
struct Receiver {
    bool is_light_sampled;
    vec3 position;
    vec3 normal;  // light arrives from its side only, or from everywhere if it is 0
};

// The receiver of a camera ray: no light sample is taken at the camera.
const Receiver NO_RECEIVER = Receiver(false, vec3(0.0), vec3(0.0));

// The receiver x_k. No light sample meets a dielectric's directions. A medium has no normal.
Receiver get_receiver(ShadingData s) {
    Receiver receiver = Receiver(STRATEGY != STRATEGY_BOUNCES && !s.is_dielectric, s.position, s.normal);
#ifdef FEATURE_MICROFACETS
    if (s.is_rough_dielectric) receiver.normal = vec3(0.0);
#endif
    return receiver;
}

#ifdef FEATURE_LIGHT_TREE
#include "light_tree.glsl"

// Each triangle has the same probability.
LightTriangle choose_light_uniformly(inout uvec2 seed, out vec2 u) {
    uint count = uint(light_triangles.length());
    uvec2 words = get_random_words(seed);
    u = to_numbers(words);
    uint digits;
    LightTriangle light = light_triangles[get_random_index(count, words, digits)];
    u.x = to_numbers(uvec2(digits)).x;
    light.inverse_density = light_leaves[get_light_place(light.instance, light.triangle)].area * float(count);
    return light;
}

// Half of the light samples go to the light probe, if there is one.
const float TRIANGLE_PROBABILITY = HAS_LIGHT_PROBE_CELLS ? 1.0 - LIGHT_PROBE_PROBABILITY : 1.0;

// Chooses a triangle for a light sample at x_k, and two numbers in [0,1) for a point on it.
LightTriangle choose_light(ShadingData s, inout uvec2 seed, out vec2 u) {
    if (LIGHT_CHOICE == CHOOSES_BY_POWER) return choose_light_triangle(seed, u);
    LightTriangle light;
    if (LIGHT_CHOICE == CHOOSES_UNIFORMLY)
        light = choose_light_uniformly(seed, u);
    else
        light = choose_light_by_tree(get_receiver(s), seed, u);
    light.inverse_density /= TRIANGLE_PROBABILITY;
    return light;
}

// p_A, the density with respect to area that the receiver's light sample has at the emissive point x_k.
float get_light_density(Receiver receiver, ShadingData s) {
    if (LIGHT_CHOICE == CHOOSES_BY_POWER || s.light_density == 0.0) return s.light_density;
    LightLeaf leaf = light_leaves[s.light];
    bool is_uniform = LIGHT_CHOICE == CHOOSES_UNIFORMLY;
    float probability = is_uniform ? 1.0 / float(light_triangles.length()) : get_tree_probability(receiver, leaf.trail);
    return TRIANGLE_PROBABILITY * probability / leaf.area;
}
#else
LightTriangle choose_light(ShadingData s, inout uvec2 seed, out vec2 u) { return choose_light_triangle(seed, u); }
float get_light_density(Receiver receiver, ShadingData s) { return s.light_density; }
#endif
