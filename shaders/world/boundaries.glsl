// Which medium is where: what rays meet at the boundaries of bodies (see common/scene/bodies.h).

// The media on the two sides of what a path meets. They differ at boundaries only.
struct Sides {
    uint here;    // index of the one on the ray's side
    uint beyond;  // index of the one on the other side
};

// A ray that goes on behind what it hits, whatever that is.
Ray get_ray_behind(Hit hit, vec3 direction) { return get_ray_from_surface(get_shading_data(hit, direction), direction); }

#ifdef FEATURE_BOUNDARIES
// The sides of one boundary, as if no other body overlapped with its body.
Sides get_sides_of(Boundary boundary, Hit hit, vec3 ray_direction) {
    bool is_front = dot(get_surface_point(hit).geometric_normal, ray_direction) < 0.0;
    if (is_front) return Sides(boundary.before, boundary.behind);
    return Sides(boundary.behind, boundary.before);
}
#endif

#ifdef FEATURE_OVERLAPS
// Whether a ray starts in a body, which it does if it leaves the body before it enters it.
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

// The media on both sides of what a ray hits: those of a boundary, or on an opaque surface twice `medium`, which its path knows.
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

// The medium that a direction leads into, from a surface or from a point in a medium.
uint get_side(Sides sides, ShadingData s, vec3 direction) {
    return dot(s.geometric_normal, direction) < 0.0 ? sides.beyond : sides.here;
}

// Whether a ray hits no surface here, but only the end of a medium.
bool is_open_boundary(Hit hit) {
#ifdef FEATURE_OPEN_BOUNDARIES
    return get_boundary(hit.instance, hit.triangle).kind == BOUNDARY_OPEN;
#else
    return false;
#endif
}

// The medium where a camera ray starts: the one before the first boundary that it meets, however many surfaces come first.
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
