// p_l of a direction that misses all triangles. Light samples look it up just like bounces, so their weights add up to one,
// however inaccurately a device computes where a direction lies on the probe.
float get_background_density(vec3 direction) {
    if (!HAS_LIGHT_PROBE_CELLS) return 0.0;
    uvec2 count = get_probe_cell_count();
    vec2 position = get_probe_position(direction);
    uvec2 cell = min(uvec2(vec2(fract(position.x), position.y) * vec2(count)), count - 1u);
    return get_probe_cell_density(cell.y * count.x + cell.x);
}

// Samples a unit direction with density P/Δω.
vec3 sample_light_probe_direction(inout uvec2 seed, out float density) {
    vec2 u;
    uint index = choose_probe_cell(seed, u);
    density = get_probe_cell_density(index);
    uvec2 count = get_probe_cell_count();
    uvec2 cell = uvec2(index % count.x, index / count.x);

    // The azimuth is uniform, and so is cos θ between the cell's edges. Close to the pole cos θ is close to 1, so we sample
    // 1 - cos θ = 2 sin² θ/2 instead, and mirror the lower half.
    bool is_lower = 2u * cell.y >= count.y;
    float row = float(is_lower ? count.y - 1u - cell.y : cell.y);
    float edge = sin(0.5 * PI * row / float(count.y)), next_edge = sin(0.5 * PI * (row + 1.0) / float(count.y));
    float one_minus_cos = 2.0 * mix(edge * edge, next_edge * next_edge, u.y);
    float sin_theta = sqrt(one_minus_cos * (2.0 - one_minus_cos));
    float azimuth = 2.0 * PI * ((float(cell.x) + u.x) / float(count.x) - 0.5) - parameters.probe_rotation;
    float height = is_lower ? one_minus_cos - 1.0 : 1.0 - one_minus_cos;
    return vec3(sin_theta * sin(azimuth), height, -sin_theta * cos(azimuth));
}

// Estimates the light of the probe that x_k reflects along ω_o from one direction, weighted against bounces.
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

// Estimates the direct light at x_k: of the probe, and of the light triangles.
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    vec3 direct = vec3(0.0);
    if (HAS_LIGHT_PROBE_CELLS) direct += sample_light_probe(s, seed);
    if (HAS_LIGHT_TRIANGLES) direct += sample_light_triangle(s, seed);
    return direct;
}
