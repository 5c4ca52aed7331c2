// p_l of a direction that misses all triangles. Light samples look it up as well as bounces, so that their weights add up
// to one, however inexactly a device computes where a direction lies on the probe.
float get_background_density(vec3 direction) {
    if (!HAS_LIGHT_PROBE_CELLS) return 0.0;
    uvec2 count = get_probe_cell_count();
    vec2 position = get_probe_position(direction);
    uvec2 cell = min(uvec2(vec2(fract(position.x), position.y) * vec2(count)), count - 1u);
    return get_probe_cell_density(cell.y * count.x + cell.x);
}

// A unit direction with the density P/Δω.
vec3 sample_light_probe_direction(inout uvec2 seed, out float density) {
    // choose the cell
    vec2 u;
    uint index = choose_probe_cell(seed, u);
    density = get_probe_cell_density(index);

    // position on the probe, (0,0) is the upper left corner
    uvec2 count = get_probe_cell_count();
    uvec2 cell = uvec2(index % count.x, index / count.x);
    vec2 position = (vec2(cell) + u) / vec2(count);

    // The direction must be uniform in the solid angle, so the height is linear: from 1 at the top to -1 at the bottom.
    float height = 1.0 - 2.0 * position.y;
    float sin_theta = sqrt(1.0 - height * height);
    float azimuth = 2.0 * PI * (position.x - 0.5) - parameters.probe_rotation;
    return vec3(sin_theta * sin(azimuth), height, -sin_theta * cos(azimuth));
}

// The light of the probe that x_k reflects along ω_o, as far as it is left to one direction to the probe.
vec3 sample_light_probe(ShadingData s, inout uvec2 seed) {
    float sampled_density;
    vec3 omega = sample_light_probe_direction(seed, sampled_density);
    // Rarely the look-up rounds to a black neighbour of the sampled cell.
    float light_density = get_background_density(omega);
    if (!is_above_surface(s, omega) || light_density == 0.0) return vec3(0.0);
    if (is_occluded(get_ray_from_surface(s, omega), NO_LIMIT)) return vec3(0.0);

    // The last factor is 1, unless the look-up rounds to another cell.
    return get_light_sample_weight(s, omega, light_density) * get_background_radiance(omega) *
           (light_density / sampled_density);
}

// The direct light at x_k by one light sample: of the probe or of the light triangles.
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    bool is_from_probe = HAS_LIGHT_PROBE_CELLS && (!HAS_LIGHT_TRIANGLES || happens(LIGHT_PROBE_PROBABILITY, seed));
    return is_from_probe ? sample_light_probe(s, seed) : sample_light_triangle(s, seed);
}
