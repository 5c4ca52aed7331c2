// The cell of the probe that a direction lies in.
uint find_probe_cell(vec3 direction) {
    ivec2 count = ivec2(get_probe_cell_count());
    vec2 place = get_probe_position(direction);
    place.x -= floor(place.x);
    ivec2 cell = clamp(ivec2(floor(place * vec2(count))), ivec2(0), count - 1);
    return uint(cell.y * count.x + cell.x);
}

float get_background_density(vec3 direction) {
    return HAS_LIGHT_PROBE_CELLS ? get_probe_cell_density(find_probe_cell(direction)) : 0.0;
}

// The squared sine of half the inclination of a row's upper edge, for rows from the top: (1 - cos θ) / 2.
float get_edge(uint row, uint rows) {
    float sine = sin(PI * float(row) / (2.0 * float(rows)));
    return sine * sine;
}

vec3 sample_light_probe_direction(inout uvec2 seed, out float density) {
    vec2 u;
    uint chosen = choose_probe_cell(seed, u);
    uvec2 count = get_probe_cell_count();
    uint column = chosen % count.x, row = chosen / count.x;
    density = get_probe_cell_density(chosen);

    // (1 - cos θ) / 2 is uniform between the edges. The lower half of the sphere is sampled as the upper one, upside down.
    float up = 1.0;
    if (row >= count.y - row) {
        row = count.y - 1u - row;
        up = -1.0;
    }
    float low = get_edge(row, count.y);
    float square = low + (1.0 - u.y) * (get_edge(row + 1u, count.y) - low);
    // sin θ = 2 sin θ/2 cos θ/2
    float sin_theta = 2.0 * sqrt(square * (1.0 - square));
    float turn = (float(column) + (1.0 - u.x)) / float(count.x);
    float azimuth = PI * (2.0 * turn - 1.0) - parameters.probe_rotation;
    return vec3(sin(azimuth) * sin_theta, up * (1.0 - 2.0 * square), -cos(azimuth) * sin_theta);
}

vec3 sample_light_probe(ShadingData s, inout uvec2 seed) {
    float chosen_density;
    vec3 omega = sample_light_probe_direction(seed, chosen_density);
    if (!is_above_surface(s, omega)) return vec3(0.0);
    float p_l = get_background_density(omega);
    if (!(p_l > 0.0) || is_occluded(get_ray_from_surface(s, omega), NO_LIMIT)) return vec3(0.0);
    vec3 light = get_background_radiance(omega) / chosen_density;
    return light * (get_light_sample_weight(s, omega, p_l) * p_l);
}

vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    if (!HAS_LIGHT_PROBE_CELLS) return sample_light_triangle(s, seed);
    if (HAS_LIGHT_TRIANGLES && happens(1.0 - LIGHT_PROBE_PROBABILITY, seed)) return sample_light_triangle(s, seed);
    return sample_light_probe(s, seed);
}
