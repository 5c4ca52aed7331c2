// The path loop, whatever light samples are: sample_direct_light() takes them, and get_background_density() is their density p_l,
// with respect to solid angle, in a direction that misses all triangles. A bounce is a function of its own, so that chapter 10
// can call it from another loop.

// What a path carries from bounce to bounce.
struct Path {
    Ray ray;  // x_{k-1}, ω_{k-1}
    vec3 radiance;
    vec3 throughput;
    uint path_length;      // the slides' k-1
    float radiance_scale;  // 1/η² for every medium entered, see chapter 6
    Receiver receiver;     // x_{k-1}, as its light sample sees it
    float bounce_density;  // p_b of the ray's direction, if a light sample could have found it
};

// A path that begins with this camera ray.
Path start_path(Ray ray) { return Path(ray, vec3(0.0), vec3(1.0), 0u, 1.0, NO_RECEIVER, 0.0); }

// Extends the path by one bounce and adds the radiance that it finds. Returns false where the path ends.
bool extend_path(inout Path path, inout uvec2 seed) {
    // Trace the ray x_{k-1}, ω_{k-1}. If it misses all triangles, it sees the background.
    Hit hit;
    if (!trace_ray(path.ray, NO_LIMIT, hit)) {
        float light_density = path.receiver.is_light_sampled ? get_background_density(path.ray.direction) : 0.0;
        if (is_counted(path.path_length))
            path.radiance += path.radiance_scale * path.throughput *
                             get_bounce_part(light_density, path.bounce_density) *
                             get_background_radiance(path.ray.direction);
        return false;
    }

    // The emitted radiance L_{e,k}, or the part of it that x_{k-1}'s light sample leaves to this bounce.
    ShadingData s = get_shading_data(hit, path.ray.direction);
    path.throughput *= s.transmittance;
    float cos_light = dot(s.geometric_normal, s.out_direction);
    float light_density = 0.0;
    if (path.receiver.is_light_sampled)
        light_density = to_solid_angle(get_light_density(path.receiver, s), hit.distance, cos_light);
    if (is_counted(path.path_length) && counts_lamps(path.receiver))
        path.radiance += path.radiance_scale * path.throughput *
                         get_bounce_part(light_density, path.bounce_density) * s.emission;
    if (path.path_length == parameters.max_path_length || !is_above_surface(s, s.out_direction)) return false;

    count_scattering(s, path.radiance);

    // The direct light at x_k arrives after one more bounce.
    path.receiver = get_receiver(s);
    if (path.receiver.is_light_sampled) {
        vec3 direct_light = sample_direct_light(s, seed);
        if (is_counted(path.path_length + 1u)) path.radiance += path.radiance_scale * path.throughput * direct_light;
    }

    // Sample ω_k.
    BsdfSample bounce = sample_bsdf(s, seed);
    if (bounce.weight == vec3(0.0)) return false;
    path.throughput *= bounce.weight;
    path.radiance_scale *= bounce.radiance_scale;
    path.bounce_density = STRATEGY == STRATEGY_LIGHT ? 0.0 : bounce.density;

    // Russian roulette with the survival probability q = min(max throughput / β_s, cap).
    if (path.path_length + 1u >= parameters.roulette_start) {
        float survival_probability =
            min(max_component(path.throughput) / parameters.survival_weight, parameters.survival_cap);
        if (!happens(survival_probability, seed)) return false;
        path.throughput /= survival_probability;
    }
    path.ray = get_ray_from_surface(s, bounce.direction);
    ++path.path_length;
    return true;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Path path = start_path(ray);
    while (extend_path(path, seed)) {
    }
    return path.radiance;
}
