// Marco's homework. p_l of a direction that misses all triangles. Light samples look it up as well as bounces, so that their weights add up
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

// The light of the probe at x_k: direction, shadow, weight. Written like sample_light_triangle(), the sky takes the light's place.
vec3 sample_light_probe(ShadingData s, inout uvec2 seed) {
    float p;
    vec3 omega = sample_light_probe_direction(seed, p);
    if (!is_above_surface(s, omega)) return vec3(0.0);

    // Is the sky visible?
    vec3 somewhere_in_the_sky = s.position + omega;
    if (is_occluded(get_ray_to_point(s, somewhere_in_the_sky), 1.0)) return vec3(0.0);

    float p_lookup = get_background_density(omega);
    if (p_lookup == 0.0) return vec3(0.0);
    vec3 L = get_background_radiance(omega);
    return L * get_light_sample_weight(s, omega, p_lookup) * (p_lookup / p);
}

// One light sample: of the probe or of the light triangles.
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    bool probe = HAS_LIGHT_PROBE_CELLS;
    if (probe && HAS_LIGHT_TRIANGLES) probe = happens(LIGHT_PROBE_PROBABILITY, seed);
    if (probe) return sample_light_probe(s, seed);
    return sample_light_triangle(s, seed);
}
