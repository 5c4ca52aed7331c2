// Scattering at a surface or in a medium, and light samples for both.

// What multiplies the radiance from a direction where a path scatters: ρ n·ω at a surface, the phase function in a medium, whose
// albedo the throughput contains.
vec3 get_scattering(ShadingData s, Medium medium, vec3 omega) {
    if (is_in_medium(s)) return vec3(get_phase(medium, s.out_direction, omega));
    return is_above_surface(s, omega) ? get_brdf(s, omega) * dot(s.normal, omega) : vec3(0.0);
}

// The density of sample_scattering() with respect to solid angle.
float get_scattering_density(ShadingData s, Medium medium, vec3 omega) {
    return is_in_medium(s) ? get_phase(medium, -s.out_direction, omega) : get_bsdf_density(s, omega);
}

// Samples ω_k. The phase function is sampled exactly, so its weight is 1.
BsdfSample sample_scattering(ShadingData s, Medium medium, inout uvec2 seed) {
    if (!is_in_medium(s)) return sample_bsdf(s, seed);
    vec3 omega = sample_phase(medium, -s.out_direction, get_random_numbers(seed));
    return BsdfSample(omega, vec3(1.0), get_phase(medium, -s.out_direction, omega), 1.0);
}

// The light that arrives at x_k from one direction, dimmed by the media on its way and scattered along ω_o. A light sample found
// it; it has the weight of chapter 7 against bounces, with their densities with respect to solid angle.
vec3 scatter_light(ShadingData s, Sides sides, vec3 omega, vec3 radiance, float light_density, Ray shadow_ray, float t_max,
                   inout uvec2 seed) {
    Medium medium = get_medium(sides.here);
    vec3 scattering = get_scattering(s, medium, omega);
    if (scattering == vec3(0.0)) return vec3(0.0);
    float bounce_density = STRATEGY == STRATEGY_LIGHT ? 0.0 : get_scattering_density(s, medium, omega);
    float transmittance = get_transmittance(shadow_ray, t_max, get_side(sides, s, omega), seed);
    return scattering * radiance * (transmittance / (light_density + bounce_density));
}

// The same from a point y of a lamp. `distance_ratio` is 1 where the path itself found x_k.
vec3 scatter_lamp(ShadingData s, Sides sides, LightTriangle light, LightPoint y, float distance_ratio, inout uvec2 seed) {
    vec3 to_light = y.position - s.position;
    float distance = length(to_light);
    vec3 omega = to_light / distance;
    float cos_light = dot(y.normal, -omega);
    if (!(cos_light > 0.0)) return vec3(0.0);
    float light_density = distance_ratio * to_solid_angle(y.light_density, distance, cos_light);
    return scatter_light(s, sides, omega, y.emission * (light.inverse_density * y.light_density), light_density,
                         get_ray_to_point(s, y.position_in_front), 1.0, seed);
}

// A uniform point y on the emissive triangle of a lamp.
LightPoint get_lamp_point(LightTriangle light, vec2 u) {
    return get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));
}

// Whether a light sample goes to the light probe, with the probability that both tables contain.
bool chooses_probe(inout uvec2 seed) {
    return HAS_LIGHT_PROBE_CELLS && (!HAS_LIGHT_TRIANGLES || happens(LIGHT_PROBE_PROBABILITY, seed));
}

// Estimates the light that arrives at x_k directly and is scattered along ω_o, by one light sample. With equiangular samples, those
// of the segment find what lamps send to collisions.
vec3 sample_scattered_light(ShadingData s, Sides sides, inout uvec2 seed) {
    if (chooses_probe(seed)) {
        float sampled_density;
        vec3 omega = sample_light_probe_direction(seed, sampled_density);
        float light_density = get_background_density(omega);
        if (light_density == 0.0) return vec3(0.0);
        return scatter_light(s, sides, omega, get_background_radiance(omega) * (light_density / sampled_density), light_density,
                             get_ray_from_surface(s, omega), NO_LIMIT, seed);
    }
    if (samples_angles(get_medium(sides.here)) && is_in_medium(s)) return vec3(0.0);
    vec2 u;
    LightTriangle light = choose_light(s, seed, u);
    return scatter_lamp(s, sides, light, get_lamp_point(light, u), 1.0, seed);
}

// Estimates the light of lamps that is scattered once along a segment.
vec3 sample_segment(Segment segment, inout uvec2 seed) {
    Medium medium = get_medium(segment.medium);
    if (medium.extinction == 0.0 || !HAS_LIGHT_TRIANGLES || chooses_probe(seed)) return vec3(0.0);
    vec2 u;
    LightTriangle light = choose_light_triangle(seed, u);
    LightPoint y = get_lamp_point(light, u);
    Angles angles = get_angles(segment, y.position);
    float t = sample_distance(angles, segment.t_max, get_random_numbers(seed).x);
    ShadingData s = get_medium_point(segment.ray.origin + t * segment.ray.direction, segment.ray.direction);
    float distance_ratio = get_distance_ratio(angles, medium.extinction, t);
    return medium.albedo * scatter_lamp(s, Sides(segment.medium, segment.medium), light, y, distance_ratio, seed);
}
