// The light probe, an equirectangular image of the radiance that arrives from far away: +Y up, image centre towards -Z
// before the rotation about +Y.

#ifdef FEATURE_LIGHT_PROBE
// Where a unit direction is on the probe: (0,0) at its upper left corner, (1,1) at the lower right. The first number may
// lie outside: the probe repeats.
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

#ifdef FEATURE_LIGHT_PROBE_SAMPLING
const bool LIGHT_PROBE_SAMPLING = true;

// The probe's cells that light samples choose from: columns and rows. One a texel, unless there are very many.
uvec2 get_probe_cell_count() {
    return min(uvec2(textureSize(light_probe, 0)), uvec2(MAX_PROBE_CELL_COLUMNS, MAX_PROBE_CELL_ROWS));
}

// One of the cells in constant time, by an alias table as that of the light triangles.
uint choose_probe_cell(inout uvec2 seed) {
    uvec2 words = get_random_words(seed);
    uint index = get_random_index(uint(probe_cells.length()), words.x);
    return words.y < probe_cells[index].threshold ? index : probe_cells[index].alias;
}

// The same, and two numbers for a direction in it.
uint choose_probe_cell(inout uvec2 seed, out vec2 u) {
#ifdef LOW_DISCREPANCY
    uvec2 words = get_random_words(seed);
    u = to_numbers(words);
    uint digits, index = get_random_index(uint(probe_cells.length()), words, digits);
    return gives_way(digits, probe_cells[index].threshold, u.x) ? probe_cells[index].alias : index;
#else
    uint index = choose_probe_cell(seed);
    u = get_random_numbers(seed);
    return index;
#endif
}

// Density with which light samples find a cell's directions, with respect to solid angle.
float get_probe_cell_density(uint index) { return probe_cells[index].density; }
#else
// There is no probe, or the chapter leaves it to bounces: it leaves out what these would be called for.
const bool LIGHT_PROBE_SAMPLING = false;
uvec2 get_probe_cell_count() { return uvec2(1u); }
uint choose_probe_cell(inout uvec2 seed) { return 0u; }
uint choose_probe_cell(inout uvec2 seed, out vec2 u) {
    u = vec2(0.0);
    return 0u;
}
float get_probe_cell_density(uint index) { return 0.0; }
#endif
