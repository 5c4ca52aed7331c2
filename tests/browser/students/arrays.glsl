// Local arrays, members and parameters with names of the scene's arrays and the film.
struct Pair {
    vec2 samples[2];
    vec3 film[2];
    float positions[3];
};

vec3 mean(vec3 normals[2], float ray_counters[2]) { return normals[0] * ray_counters[0] + normals[1] * ray_counters[1]; }

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec2 samples[2];
    samples[0] = vec2(0.25, 0.5);
    samples[1] = vec2(0.125, 1.0);
    Pair pair;
    pair.samples[0] = samples[1];
    pair.samples[1] = samples[0];
    pair.film[0] = vec3(pair.samples[1], 2.0);
    pair.film[1] = vec3(0.5);
    for (int i = 0; i < 3; ++i) pair.positions[i] = float(i);
    vec3 film[3], materials = vec3(0.5, 0.25, 1.0);
    film[2] = mean(pair.film, float[2](1.0, 3.0));
    materials[1] = 4.0;
    return film[2] + materials + pair.positions[2] + vec3(samples[0].x, pair.samples[0]);
}
