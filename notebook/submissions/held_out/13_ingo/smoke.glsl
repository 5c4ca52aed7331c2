// Smoke: media whose density is that of a grid.
#ifdef FEATURE_DENSITIES
// Whether a medium has a grid.
bool has_grid(Medium medium) { return medium.grid_size.x > 0u; }

// The density of one cell.
float get_cell_density(Medium medium, uint x, uint y, uint z) {
    return densities[medium.first_density + x + medium.grid_size.x * (y + medium.grid_size.y * z)];
}

// The density at a position in the grid's box: trilinear between the centres of cells.
float get_density(Medium medium, vec3 position) {
    vec3 last = vec3(medium.grid_size) - 1.0;
    vec3 place = clamp((position - medium.low) / (medium.high - medium.low), vec3(0.0), vec3(1.0)) * last;
    uvec3 a = uvec3(place), b = min(a + uvec3(1u), uvec3(last));
    vec3 weight = place - vec3(a);
    vec4 left = vec4(get_cell_density(medium, a.x, a.y, a.z), get_cell_density(medium, a.x, b.y, a.z),
                     get_cell_density(medium, a.x, a.y, b.z), get_cell_density(medium, a.x, b.y, b.z));
    vec4 right = vec4(get_cell_density(medium, b.x, a.y, a.z), get_cell_density(medium, b.x, b.y, a.z),
                      get_cell_density(medium, b.x, a.y, b.z), get_cell_density(medium, b.x, b.y, b.z));
    vec4 edges = mix(left, right, weight.x);
    vec2 rows = mix(edges.xz, edges.yw, weight.y);
    return mix(rows.x, rows.y, weight.z);
}

// The t between which a ray is in the box. It is not if the first is not the smaller one.
vec2 get_range_in_box(Medium medium, Ray ray, float t_max) {
    vec3 direction = ray.direction + 1e-30;  // none of them is 0
    vec3 a = (medium.low - ray.origin) / direction, b = (medium.high - ray.origin) / direction;
    vec3 entries = min(a, b), exits = max(a, b);
    return vec2(max(max(entries.x, max(entries.y, entries.z)), 0.0), min(min(exits.x, min(exits.y, exits.z)), t_max));
}

// Delta tracking (Woodcock et al., "Techniques used in the GEM code for Monte Carlo neutronics calculations", 1965): flights as
// if the density were the largest one everywhere, so that collisions are too many. Each is real with the probability
// σ_t(x) / majorant. Otherwise nothing happens there, and the next flight starts.
float track_flight(Medium medium, Ray ray, float t_max, inout uvec2 seed) {
    float majorant = medium.extinction * medium.largest_density;
    vec2 range = get_range_in_box(medium, ray, t_max);
    // From where the ray enters the box, since a small step from a camera far away would round to none.
    float t = 0.0;
    while (t < range.y - range.x) {
        uvec2 words = get_random_words(seed);
        float v = to_numbers(words).y;
        t += get_flight_depth(words.x) / majorant;
        vec3 position = ray.origin + (range.x + t) * ray.direction;
        if (t < range.y - range.x && v * medium.largest_density < get_density(medium, position)) return range.x + t;
    }
    return NO_LIMIT;
}

// Ratio tracking (Novák et al., "Residual Ratio Tracking for Estimating Attenuation in Participating Media", 2014): the same
// flights never end, and at each collision remains the probability that it was not real. Its mean is the transmittance.
float track_transmittance(Medium medium, Ray ray, float t_max, inout uvec2 seed) {
    float majorant = medium.extinction * medium.largest_density * length(ray.direction);
    vec2 range = get_range_in_box(medium, ray, t_max);
    float transmittance = 1.0, t = 0.0;
    while (t < range.y - range.x) {
        t += get_flight_depth(get_random_words(seed).x) / majorant;
        vec3 position = ray.origin + (range.x + t) * ray.direction;
        if (t < range.y - range.x) transmittance *= 1.0 - get_density(medium, position) / medium.largest_density;
    }
    return transmittance;
}
#else
// A scene without smoke compiles nothing of it.
bool has_grid(Medium medium) { return false; }
float track_flight(Medium medium, Ray ray, float t_max, inout uvec2 seed) { return NO_LIMIT; }
float track_transmittance(Medium medium, Ray ray, float t_max, inout uvec2 seed) { return 1.0; }
#endif
