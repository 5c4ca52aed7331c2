// Light probe sampling, Greta. A cell of the probe is a rectangle in azimuth and cos(theta), so I sample both uniformly.

float get_background_density(vec3 direction) {
    if (!HAS_LIGHT_PROBE_CELLS) return 0.0;
    uvec2 size = get_probe_cell_count();
    vec2 p = get_probe_position(direction);
    uint column = min(uint(fract(p.x) * float(size.x)), size.x - 1u);
    uint row = min(uint(p.y * float(size.y)), size.y - 1u);
    return get_probe_cell_density(row * size.x + column);
}

vec3 sample_light_probe_direction(inout uvec2 seed, out float density) {
    vec2 u;
    uint cell = choose_probe_cell(seed, u);
    density = get_probe_cell_density(cell);

    uvec2 size = get_probe_cell_count();
    uint row = cell / size.x;
    uint column = cell - row * size.x;

    float top = cos(PI * float(row) / float(size.y));
    float bottom = cos(PI * float(row + 1u) / float(size.y));
    float y = top + (bottom - top) * u.y;
    float horizontal = sqrt(max(1.0 - y * y, 0.0));

    // The image's centre looks towards -z, a column to the right of it towards +x.
    float turn = (float(column) + u.x) / float(size.x);
    float phi = 2.0 * PI * turn - parameters.probe_rotation;
    return vec3(-horizontal * sin(phi), y, horizontal * cos(phi));
}

vec3 sample_light_probe(ShadingData s, inout uvec2 seed) {
    float p_sampled;
    vec3 w = sample_light_probe_direction(seed, p_sampled);
    if (!is_above_surface(s, w)) return vec3(0.0);
    float p = get_background_density(w);
    if (p <= 0.0 || is_occluded(get_ray_from_surface(s, w), NO_LIMIT)) return vec3(0.0);
    return (p / p_sampled) * get_light_sample_weight(s, w, p) * get_background_radiance(w);
}

vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    if (!HAS_LIGHT_PROBE_CELLS) return sample_light_triangle(s, seed);
    if (HAS_LIGHT_TRIANGLES && !happens(LIGHT_PROBE_PROBABILITY, seed)) return sample_light_triangle(s, seed);
    return sample_light_probe(s, seed);
}
