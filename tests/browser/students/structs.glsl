// structs within functions and returned, chained calls
struct Sheet { float pixels[3]; };
Sheet make(float x) { Sheet film; for (int i = 0; i < 3; ++i) film.pixels[i] = x * float(i); return film; }
vec3 path_trace(Ray ray, inout uvec2 seed) {
    struct Local { vec2 samples[2]; } local;
    local.samples[0] = vec2(0.5); local.samples[1] = vec2(make(2.0).pixels[2], 1.0);
    Sheet film[2];
    film[0] = make(1.0); film[1] = make(3.0);
    return vec3(local.samples[1], film[1].pixels[2] + local.samples[0].x);
}
