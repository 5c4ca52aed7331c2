float get_background_density(vec3 direction) {
    if (!HAS_LIGHT_PROBE_CELLS) return 0.0;
    uvec2 size = get_probe_cell_count();
    vec2 st = get_probe_position(direction);
    st.x -= floor(st.x);
    uvec2 cell = uvec2(st * vec2(size));
    cell = min(cell, size - uvec2(1u));
    return get_probe_cell_density(cell.x + size.x * cell.y);
}

// Importance sampling of the environment map.
vec3 sample_light_probe_direction(inout uvec2 seed, out float density) {
    vec2 jitter;
    uint cell = choose_probe_cell(seed, jitter);
    density = get_probe_cell_density(cell);
    vec2 size = vec2(get_probe_cell_count());
    float column = float(cell % uint(size.x)), row = float(cell / uint(size.x));

    // Uniform in cos(theta) between the upper and the lower edge of the cell.
    bool mirrored = 2.0 * row >= size.y;
    if (mirrored) row = size.y - 1.0 - row;
    float a = sin(0.5 * PI * row / size.y), b = sin(0.5 * PI * (row + 1.0) / size.y);
    float v = 2.0 * mix(a * a, b * b, jitter.y);  // 1 - cos(theta)
    float sin_theta = sqrt(v * (2.0 - v));
    float phi = 2.0 * PI * ((column + jitter.x) / size.x - 0.5) + parameters.probe_rotation;
    return vec3(sin_theta * sin(phi), mirrored ? v - 1.0 : 1.0 - v, -sin_theta * cos(phi));
}

vec3 sample_light_probe(ShadingData s, inout uvec2 seed) {
    float pdf;
    vec3 omega = sample_light_probe_direction(seed, pdf);
    float p_l = get_background_density(omega);
    if (p_l == 0.0 || !is_above_surface(s, omega)) return vec3(0.0);
    if (is_occluded(get_ray_from_surface(s, omega), NO_LIMIT)) return vec3(0.0);
    return get_light_sample_weight(s, omega, p_l) * (p_l / pdf) * get_background_radiance(omega);
}

vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    if (HAS_LIGHT_PROBE_CELLS && HAS_LIGHT_TRIANGLES) {
        if (happens(LIGHT_PROBE_PROBABILITY, seed)) return sample_light_probe(s, seed);
        return sample_light_triangle(s, seed);
    }
    return HAS_LIGHT_PROBE_CELLS ? sample_light_probe(s, seed) : sample_light_triangle(s, seed);
}
