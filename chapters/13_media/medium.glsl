// What light meets in a medium: the phase function, points without a normal, and transmittance up to the next surface.

// The phase function of Henyey and Greenstein ("Diffuse radiation in the Galaxy", 1941), for light that travels along one unit
// direction and then along the other: (1 - g²) / (4π (1 + g² - 2 g cos θ)^(3/2)). It integrates to 1 over all directions. The
// squared difference of the directions is 2 - 2 cos θ, and exact where θ is small.
float get_phase(Medium medium, vec3 before, vec3 after) {
    float g = abs(medium.anisotropy);
    vec3 difference = (medium.anisotropy < 0.0 ? -before : before) - after;
    float square = (1.0 - g) * (1.0 - g) + g * dot(difference, difference);
    return (1.0 - g) * (1.0 + g) / (4.0 * PI * square * sqrt(square));
}

// A unit direction with the density get_phase() with respect to solid angle. The inverse of its distribution function, solved for
// 1 - cos θ, holds at g = 0, too.
vec3 sample_phase(Medium medium, vec3 before, vec2 u) {
    float g = abs(medium.anisotropy);
    float d = 1.0 - g + 2.0 * g * (1.0 - u.x);
    float one_minus_cos = (1.0 - g) * (1.0 - g) * u.x * (1.0 + g + d) / (d * d);
    float sin_theta = sqrt(max(one_minus_cos * (2.0 - one_minus_cos), 0.0));
    float phi = 2.0 * PI * u.y;
    vec3 forward = medium.anisotropy < 0.0 ? -before : before;
    return get_shading_space(forward) * vec3(cos(phi) * sin_theta, sin(phi) * sin_theta, 1.0 - one_minus_cos);
}

// A point of a medium as shading data: it has no normal, and a ray can start exactly there.
ShadingData get_medium_point(vec3 position, vec3 ray_direction) {
    ShadingData s;
    s.position = position;
    s.out_direction = -ray_direction;
    s.normal = vec3(0.0);
    s.geometric_normal = vec3(0.0);
    s.offset = 0.0;
    s.material = NO_MATERIAL;
    s.is_dielectric = false;
    return s;
}
// Whether a path scatters in a medium there, not at a surface.
bool is_in_medium(ShadingData s) { return s.normal == vec3(0.0); }

// The fraction of light that does not collide between the ray's origin and t_max, by Beer's law, or an estimate of it.
float get_transmittance_of(Medium medium, Ray ray, float t_max, inout uvec2 seed) {
    if (has_grid(medium)) return track_transmittance(medium, ray, t_max, seed);
    // Without an end t_max is so large that its product with a length may be infinite, and 0 times that is no number.
    return medium.extinction > 0.0 ? exp(-medium.extinction * t_max * length(ray.direction)) : 1.0;
}

// The fraction of light that gets through, from the ray's origin to t_max: 0 behind a surface. It goes on through open boundaries.
float get_transmittance(Ray ray, float t_max, uint medium, inout uvec2 seed) {
#ifdef FEATURE_OPEN_BOUNDARIES
    float transmittance = 1.0;
    vec3 end = ray.origin + ray.direction;
    Hit hit;
    while (trace_ray(ray, t_max, hit)) {
        if (!is_open_boundary(hit)) return 0.0;
        transmittance *= get_transmittance_of(get_medium(medium), ray, hit.distance, seed);
        medium = get_sides(hit, ray.direction, medium).beyond;
        ray = get_ray_behind(hit, ray.direction);
        if (t_max == NO_LIMIT) continue;
        // A ray that ends at a point still ends there. If that is as close behind the boundary as rays start, it has.
        vec3 rest = end - ray.origin;
        if (dot(rest, ray.direction) <= 0.0) return transmittance;
        ray.direction = rest;
    }
    return transmittance * get_transmittance_of(get_medium(medium), ray, t_max, seed);
#else
    return is_occluded(ray, t_max) ? 0.0 : get_transmittance_of(get_medium(medium), ray, t_max, seed);
#endif
}
