// The scene's emissive triangles, for next event estimation.

// How estimators find light, one of the constants STRATEGY_… that --strategy chooses. Where no light has a table to sample from, bounces find all of it.
#if !defined(FEATURE_LIGHT_TRIANGLES) && !defined(FEATURE_LIGHT_PROBE_CELLS)
#undef STRATEGY
#define STRATEGY STRATEGY_BOUNCES
#elif !defined(STRATEGY)
#define STRATEGY STRATEGY_BOTH
#endif

// A point y on the front of a light.
struct LightPoint {
    vec3 position;           // y, in scene units
    vec3 position_in_front;  // y, moved to the front of the light by a bound on the rounding errors
    vec3 normal;             // of the triangle, unit length, on the front
    vec3 emission;           // L_e, the emitted radiance towards the front
    float light_density;     // p_A, the density of light samples at y with respect to area
};

// Whether light samples can choose an emissive triangle.
#ifdef FEATURE_LIGHT_TRIANGLES
const bool HAS_LIGHT_TRIANGLES = true;

// Chooses an emissive triangle with probability proportional to its area times its luminance: in constant time, by an
// alias table.
LightTriangle choose_light_triangle(inout uvec2 seed) {
    uvec2 words = get_random_words(seed);
    uint digits, index = get_random_index(uint(light_triangles.length()), words, digits);
    if (words.y >= light_triangles[index].threshold) index = light_triangles[index].alias;
    return light_triangles[index];
}

// The same, but one pair of words serves both the choice and `u`, two numbers in [0,1) for a point on it.
LightTriangle choose_light_triangle(inout uvec2 seed, out vec2 u) {
    uvec2 words = get_random_words(seed);
    u = to_numbers(words);
    uint digits, index = get_random_index(uint(light_triangles.length()), words, digits);
    if (gives_way(digits, light_triangles[index].threshold, u.x)) index = light_triangles[index].alias;
    return light_triangles[index];
}

// The point on a light with the barycentric coordinates w_1 and w_2.
LightPoint get_light_point(LightTriangle light, vec2 barycentrics) {
    Hit hit;
    hit.instance = light.instance;
    hit.triangle = light.triangle;
    hit.barycentrics = barycentrics;
    SurfacePoint point = get_surface_point(hit);
    Material material = materials[triangle_materials[light.triangle]];
    float light_density = material.light_density;
#ifdef FEATURE_LIGHT_TREE
    light_density = 1.0 / light.inverse_density;  // it depends on where the light arrives
#endif
    return LightPoint(point.position, point.position + point.offset * point.geometric_normal, point.geometric_normal,
                      material.emission, light_density);
}
#else
// If nothing emits, or with --strategy bounces, estimators still compile but never call these.
const bool HAS_LIGHT_TRIANGLES = false;
LightTriangle choose_light_triangle(inout uvec2 seed) { return LightTriangle(0u, 0u, 0u, 0u, 0.0); }
LightTriangle choose_light_triangle(inout uvec2 seed, out vec2 u) {
    u = vec2(0.0);
    return choose_light_triangle(seed);
}
LightPoint get_light_point(LightTriangle light, vec2 barycentrics) {
    return LightPoint(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
}
#endif
