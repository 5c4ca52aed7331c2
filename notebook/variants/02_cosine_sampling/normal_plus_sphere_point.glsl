// Cosine sampling without a frame: the normal plus a uniform point of the unit sphere, normalised.
//
// Seen from x, the sphere of radius 1 about x + n is met in direction ω at distance 2 cos θ. A uniform point on it has
// density 1/(4π) per area; the area in dω is r² / cos θ' dω with r = 2 cos θ and θ' = θ (a chord meets the sphere at
// equal angles). So p(ω) = 4 cos² θ / cos θ / (4π) = cos θ / π.
vec3 sample_unit_sphere(vec2 u) {
    float z = 2.0 * u.x - 1.0;
    float azimuth = 2.0 * PI * u.y;
    return vec3(sqrt(1.0 - z * z) * vec2(cos(azimuth), sin(azimuth)), z);
}

struct Path {
    Ray ray;
    vec3 throughput;
    uint bounces;
    bool is_finished;
};

// Follows the path to its next hit and on from there. Returns what that hit adds to the picture.
vec3 advance(inout Path path, inout uvec2 seed) {
    bool is_shown = is_counted(path.bounces);
    vec3 direction = path.ray.direction;
    Hit hit;
    if (!trace_ray(path.ray, NO_LIMIT, hit)) {
        path.is_finished = true;
        return is_shown ? path.throughput * get_background_radiance(direction) : vec3(0.0);
    }
    ShadingData s = get_shading_data(hit, direction);
    vec3 found = is_shown ? path.throughput * s.emission : vec3(0.0);

    vec3 chord = s.normal + sample_unit_sphere(get_random_numbers(seed));
    vec3 next = normalize(chord);
    bool is_degenerate = dot(chord, chord) < 1e-12;  // the point opposite to the normal
    path.is_finished = path.bounces == parameters.max_path_length || is_degenerate ||
                       !is_above_surface(s, -direction) || !is_above_surface(s, next);
    if (path.is_finished) return found;

    path.throughput *= PI * get_brdf(s, next);
    path.ray = get_ray_from_surface(s, next);
    ++path.bounces;
    return found;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Path path = Path(ray, vec3(1.0), 0u, false);
    vec3 radiance = vec3(0.0);
    while (!path.is_finished) radiance += advance(path, seed);
    return radiance;
}
