// Macros that stand for names, declarations, loops and the scene's arrays.
#define ALBEDO(i) materials[i].diffuse_albedo
#define LIST(type, name, count) type name[count]
#define REPEAT(i, n) for (int i = 0; i < n; ++i)
#define samples points
#define BLEND(a, b, \
              t) mix(a, b, t)
#define TWICE(x) ((x) + (x))
#if defined(FEATURE_LIGHT_TRIANGLES) && !defined NOTHING && (3 * 2 + 1 == 7)
const float SCALE = 0.5;
#else
#error a wrong branch
#endif

vec3 path_trace(Ray ray, inout uvec2 seed) {
    LIST(vec3, film, 2);
    LIST(float, samples, 3);
    REPEAT(i, 2) film[i] = ALBEDO(i) * SCALE;
    REPEAT(i, 3) {
        samples[i] = float(i);
    }
    vec3 sum = BLEND(film[0], film[1],
                     0.25);
#undef samples
    float samples[1];
    samples[0] = points[2];
    return sum + TWICE(TWICE(samples[0]));
}
