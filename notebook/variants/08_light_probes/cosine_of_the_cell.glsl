// Cells are found and sampled by cos θ itself.

// Row and column of a direction on the probe, and its density.
uint find_cell(vec3 direction) {
    uvec2 count = get_probe_cell_count();
    float turns = (atan(direction.x, -direction.z) + parameters.probe_rotation) / (2.0 * PI) + 0.5;
    float row = float(count.y) * acos(clamp(direction.y, -1.0, 1.0)) / PI;
    uint column = uint(float(count.x) * (turns - floor(turns)));
    return min(uint(row), count.y - 1u) * count.x + min(column, count.x - 1u);
}

float get_background_density(vec3 direction) {
    return HAS_LIGHT_PROBE_CELLS ? get_probe_cell_density(find_cell(direction)) : 0.0;
}

// Light of the probe by one light sample, weighted against a bounce.
vec3 sample_sky(ShadingData s, inout uvec2 seed) {
    uvec2 count = get_probe_cell_count();
    vec2 u;
    uint chosen = choose_probe_cell(seed, u);
    float made_with = get_probe_cell_density(chosen);
    float row_height = PI / float(count.y), upper = float(chosen / count.x) * row_height;
    float z = cos(upper) + u.x * (cos(upper + row_height) - cos(upper));
    float phi = 2.0 * PI * (float(chosen % count.x) + u.y) / float(count.x) - PI - parameters.probe_rotation;
    float across = sqrt(max(0.0, 1.0 - z * z));
    vec3 toward = vec3(across * sin(phi), z, -across * cos(phi));
    if (!is_above_surface(s, toward) || is_occluded(get_ray_from_surface(s, toward), NO_LIMIT)) return vec3(0.0);
    float own = get_background_density(toward), other = STRATEGY == STRATEGY_LIGHT ? 0.0 : get_bsdf_density(s, toward);
    if (own == 0.0) return vec3(0.0);
    float share = own / (own + other);
    return share * get_background_radiance(toward) * get_brdf(s, toward) * dot(s.normal, toward) / made_with;
}

vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    bool is_from_probe = HAS_LIGHT_PROBE_CELLS && (!HAS_LIGHT_TRIANGLES || happens(LIGHT_PROBE_PROBABILITY, seed));
    return is_from_probe ? sample_sky(s, seed) : sample_light_triangle(s, seed);
}
