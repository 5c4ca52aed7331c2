// The light probe: an equirectangular image of the radiance that arrives from infinity. +Y is up, and the image centre lies
// towards -Z before the rotation about +Y.

#ifdef FEATURE_LIGHT_PROBE
// Maps a unit direction to its position on the probe: (0,0) is the upper left corner, (1,1) the lower right one. The first
// coordinate may lie outside [0,1], since the probe repeats.
vec2 get_probe_position(vec3 direction) {
    // Straight up and down the azimuth is undefined, and so is atan().
    bool is_pole = direction.x == 0.0 && direction.z == 0.0;
    float azimuth = is_pole ? 0.0 : atan(direction.x, -direction.z);
    // Near the poles acos() would lose all digits.
    float inclination = atan(length(direction.xz), direction.y);
    return vec2(0.5 + (azimuth + parameters.probe_rotation) / (2.0 * PI), inclination / PI);
}

// Radiance of the light probe in a unit direction.
vec3 get_light_probe_radiance(vec3 direction) {
    TexelNeighbours t =
        get_texel_neighbours(get_probe_position(direction), textureSize(light_probe, 0), false);
    return mix_texels(texelFetch(light_probe, t.upper_left, 0),
                      texelFetch(light_probe, ivec2(t.lower_right.x, t.upper_left.y), 0),
                      texelFetch(light_probe, ivec2(t.upper_left.x, t.lower_right.y), 0),
                      texelFetch(light_probe, t.lower_right, 0), t.weights);
}
#else
vec2 get_probe_position(vec3 direction) { return vec2(0.0); }
#endif

// Whether light samples can choose a direction of the light probe.
#ifdef FEATURE_LIGHT_PROBE_CELLS
const bool HAS_LIGHT_PROBE_CELLS = true;

// Columns and rows of the cells that light samples choose from: one cell per texel, unless the probe is very large.
uvec2 get_probe_cell_count() {
    return min(uvec2(textureSize(light_probe, 0)), uvec2(MAX_PROBE_CELL_COLUMNS, MAX_PROBE_CELL_ROWS));
}

// Chooses a cell in constant time from an alias table, and returns two numbers in [0,1) for a direction in it.
uint choose_probe_cell(inout uvec2 seed, out vec2 u) {
    uvec2 words = get_random_words(seed);
    u = to_numbers(words);
    uint digits, index = get_random_index(uint(probe_cells.length()), words, digits);
    return gives_way(digits, probe_cells[index].threshold, u.x) ? probe_cells[index].alias : index;
}

// The density with which light samples find a direction of the cell, with respect to solid angle.
float get_probe_cell_density(uint index) { return probe_cells[index].density; }
#else
// Without a probe, or if only bounces find it, estimators still compile but never call these.
const bool HAS_LIGHT_PROBE_CELLS = false;
uvec2 get_probe_cell_count() { return uvec2(1u); }
uint choose_probe_cell(inout uvec2 seed, out vec2 u) {
    u = vec2(0.0);
    return 0u;
}
float get_probe_cell_density(uint index) { return 0.0; }
#endif
