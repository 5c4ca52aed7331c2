// The scene's emissive triangles, for next event estimation.

struct LightPoint {
    vec3 position;           // y
    vec3 position_in_front;  // y, moved off the light to its front by a bound of the rounding errors
    vec3 normal;             // of the triangle, unit length, on the front
    vec3 emission;           // L_e towards the front
    float light_density;     // of y with respect to area; with it weights are computed, see ShadingData
};

#ifdef FEATURE_LIGHT_SAMPLING
const bool LIGHT_SAMPLING = true;

// One of all emissive triangles, with probability proportional to area times luminance: in constant time, however many
// there are, by an alias table. Two 32-bit words choose it.
LightTriangle choose_light_triangle(inout uvec2 seed) {
    uvec2 words = get_random_words(seed);
    uint index = get_random_index(uint(light_triangles.length()), words.x);
    if (words.y >= light_triangles[index].threshold) index = light_triangles[index].alias;
    return light_triangles[index];
}

// The same, and two numbers for a point on it.
LightTriangle choose_light_triangle(inout uvec2 seed, out vec2 u) {
#ifdef LOW_DISCREPANCY
    uvec2 words = get_random_words(seed);
    u = to_numbers(words);
    uint digits, index = get_random_index(uint(light_triangles.length()), words, digits);
    if (gives_way(digits, light_triangles[index].threshold, u.x)) index = light_triangles[index].alias;
    return light_triangles[index];
#else
    LightTriangle light = choose_light_triangle(seed);
    u = get_random_numbers(seed);
    return light;
#endif
}

// The point of a light with the barycentric coordinates w_1 and w_2.
LightPoint get_light_point(LightTriangle light, vec2 barycentrics) {
    Hit hit;
    hit.instance = light.instance;
    hit.triangle = light.triangle;
    hit.barycentrics = barycentrics;
    SurfacePoint point = get_surface_point(hit);
    Material material = materials[triangle_materials[light.triangle]];
    return LightPoint(point.position, point.position + point.offset * point.geometric_normal, point.geometric_normal,
                      material.emission, material.light_density);
}
#else
// Nothing emits, or --light-sampling off: the estimators leave out what these would be called for.
const bool LIGHT_SAMPLING = false;
LightTriangle choose_light_triangle(inout uvec2 seed) { return LightTriangle(0u, 0u, 0u, 0u, 0.0); }
LightTriangle choose_light_triangle(inout uvec2 seed, out vec2 u) {
    u = vec2(0.0);
    return choose_light_triangle(seed);
}
LightPoint get_light_point(LightTriangle light, vec2 barycentrics) {
    return LightPoint(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
}
#endif

// Whether light that a bounce finds counts, where light samples could have found it: not so with --strategy light.
#ifdef ONLY_LIGHT_SAMPLES
const bool BOUNCES_FIND_LIGHTS = false;
#else
const bool BOUNCES_FIND_LIGHTS = true;
#endif
