// Scattering at a surface or in a medium, and light samples for both.

// What multiplies the radiance from a direction where a path scatters: ρ |n·ω| at a surface, the phase function in a medium.
vec3 get_scattering(ShadingData s, Medium medium, vec3 omega) {
    if (is_in_medium(s)) return medium.albedo * get_phase(medium, -s.out_direction, omega);
    return is_above_surface(s, omega) ? get_brdf(s, omega) * dot(s.normal, omega) : vec3(0.0);
}

// The density of sample_scattering() with respect to solid angle.
float get_scattering_density(ShadingData s, Medium medium, vec3 omega) {
    return is_in_medium(s) ? get_phase(medium, -s.out_direction, omega) : get_bsdf_density(s, omega);
}

// Samples ω_k. The phase function is sampled exactly, so the weight of a collision is the albedo.
BsdfSample sample_scattering(ShadingData s, Medium medium, inout uvec2 seed) {
    if (!is_in_medium(s)) return sample_bsdf(s, seed);
    vec3 omega = sample_phase(medium, -s.out_direction, get_random_numbers(seed));
    return BsdfSample(omega, medium.albedo, get_phase(medium, -s.out_direction, omega), false, 1.0);
}

// Estimates the light that arrives at x_k directly and is scattered along ω_o, by one light sample weighted against bounces as
// in chapter 7. On its way a medium dims it.
vec3 sample_scattered_light(ShadingData s, Sides sides, inout uvec2 seed) {
    vec3 omega, radiance;
    float light_density;  // with respect to solid angle
    Ray shadow_ray;
    float t_max = NO_LIMIT;
    if (HAS_LIGHT_PROBE_CELLS && (!HAS_LIGHT_TRIANGLES || happens(LIGHT_PROBE_PROBABILITY, seed))) {
        float sampled_density;
        omega = sample_light_probe_direction(seed, sampled_density);
        light_density = get_background_density(omega);
        if (light_density == 0.0) return vec3(0.0);
        radiance = get_background_radiance(omega) * (light_density / sampled_density);
        shadow_ray = get_ray_from_surface(s, omega);
    } else {
        vec2 u;
        LightTriangle light = choose_light_triangle(seed, u);
        LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));
        vec3 to_light = y.position - s.position;
        float distance = length(to_light);
        omega = to_light / distance;
        float cos_light = dot(y.normal, -omega);
        if (!(cos_light > 0.0)) return vec3(0.0);
        light_density = to_solid_angle(y.light_density, distance, cos_light);
        radiance = y.emission * (light.inverse_density * y.light_density);
        shadow_ray = get_ray_to_point(s, y.position_in_front);
        t_max = 1.0;
    }
    Medium medium = media[sides.here];
    vec3 scattering = get_scattering(s, medium, omega);
    if (scattering == vec3(0.0)) return vec3(0.0);
    float bounce_density = STRATEGY == STRATEGY_LIGHT ? 0.0 : get_scattering_density(s, medium, omega);
    float transmittance = get_transmittance(shadow_ray, t_max, get_side(sides, s, omega));
    return scattering * radiance * (transmittance / (light_density + bounce_density));
}
