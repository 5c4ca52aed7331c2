// What light meets in a medium: the phase function, and which medium is where.

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
    s.is_dielectric = false;
    return s;
}
// Whether a path scatters in a medium there, not at a surface.
bool is_in_medium(ShadingData s) { return s.normal == vec3(0.0); }

// The media on the two sides of what a path meets, as indices: on the ray's side and beyond. They differ at boundaries only.
struct Sides {
    uint here;
    uint beyond;
};

// A ray that goes on behind what it hits, whatever that is.
Ray get_ray_behind(Hit hit, vec3 direction) { return get_ray_from_surface(get_shading_data(hit, direction), direction); }

#ifdef FEATURE_BOUNDARIES
// Those of a boundary, as if no other body overlapped with its own.
Sides get_sides_of(Boundary boundary, Hit hit, vec3 ray_direction) {
    bool is_front = dot(get_surface_point(hit).geometric_normal, ray_direction) < 0.0;
    return is_front ? Sides(boundary.before, boundary.behind) : Sides(boundary.behind, boundary.before);
}
#endif

#ifdef FEATURE_OVERLAPS
// Whether a ray starts in a body: whether it leaves that before it enters it.
bool starts_in(uint body, Ray ray) {
    Hit hit;
    while (trace_ray(ray, NO_LIMIT, hit)) {
        Boundary boundary = get_boundary(hit.instance, hit.triangle);
        if (boundary.kind != BOUNDARY_NONE && boundary.body == body)
            return get_sides_of(boundary, hit, ray.direction).here == body;
        ray = get_ray_behind(hit, ray.direction);
    }
    return false;
}
#endif

// A ray knows its medium only from its path, or from the next boundary, as here. An opaque surface has the same on both sides.
Sides get_sides(Hit hit, vec3 ray_direction, uint medium) {
    Sides sides = Sides(medium, medium);
#ifdef FEATURE_BOUNDARIES
    Boundary boundary = get_boundary(hit.instance, hit.triangle);
    if (boundary.kind == BOUNDARY_NONE) return sides;
    sides = get_sides_of(boundary, hit, ray_direction);
#ifdef FEATURE_OVERLAPS
    // The smallest body around a point is there, which is the one with the largest index.
    Ray ray = get_ray_behind(hit, ray_direction);
    for (uint i = boundary.first_overlap; i < boundary.end_overlaps; ++i) {
        uint other = overlaps[i];
        if (min(sides.here, sides.beyond) < other && starts_in(other, ray))
            sides = Sides(max(sides.here, other), max(sides.beyond, other));
    }
#endif
#endif
    return sides;
}

// The medium at a direction's origin on a surface or in a medium.
uint get_side(Sides sides, ShadingData s, vec3 direction) {
    return dot(s.geometric_normal, direction) < 0.0 ? sides.beyond : sides.here;
}

// Whether what a ray hits is no surface, but only the end of a medium.
bool is_open_boundary(Hit hit) {
#ifdef FEATURE_OPEN_BOUNDARIES
    return get_boundary(hit.instance, hit.triangle).kind == BOUNDARY_OPEN;
#else
    return false;
#endif
}

// The medium where a camera ray starts: the one on this side of the next boundary, behind all that stands in front of it.
uint find_medium(Ray ray) {
#ifdef FEATURE_BOUNDARIES
    Hit hit;
    while (trace_ray(ray, NO_LIMIT, hit)) {
        if (get_boundary(hit.instance, hit.triangle).kind != BOUNDARY_NONE) return get_sides(hit, ray.direction, 0u).here;
        ray = get_ray_behind(hit, ray.direction);
    }
#endif
    return 0u;
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
