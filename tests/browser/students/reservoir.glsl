// reservoir, with members named as buffers
struct Reservoir { LightTriangle light_triangles; float weight; uint samples; };
void update(inout Reservoir film, LightTriangle light, float w, float u) {
    film.weight += w;
    film.samples++;
    if (u * film.weight < w) film.light_triangles = light;
}
vec3 path_trace(Ray ray, inout uvec2 seed) {
    Reservoir r = Reservoir(light_triangles[0], 0.0, 0u);
    for (uint i = 0u; i < uint(light_triangles.length()); i++) update(r, light_triangles[i], float(i + 1u), 0.5);
    return vec3(r.weight, float(r.samples), float(r.light_triangles.triangle));
}
