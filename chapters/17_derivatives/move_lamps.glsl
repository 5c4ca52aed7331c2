// How the direct light at x_1 changes where all lamps move along an axis.
//
// What a light sample finds at the point y of a lamp depends on the place of y in three ways. With d = y - x_1, n the normal at x_1
// and m that at y, the geometry factor of chapter 3 and its derivative along the axis a are
//   G = (n·d) (-m·d) / (d·d)²,   ∂ ln G / ∂y_a = n_a / (n·d) + m_a / (m·d) - 4 d_a / (d·d).
// The visibility V is a fourth: it jumps where the edge of a shadow passes. No sample ever meets the jump, so this derivative
// lacks what the edges contribute.

// The axis, 1 for x: --move-lamps sets it. 0: lamps stay.
#ifndef MOVE_LAMPS
#define MOVE_LAMPS 0
#endif

#if MOVE_LAMPS > 0
#if defined(FEATURE_SPECULAR) || defined(FEATURE_MICROFACETS) || defined(FEATURE_MEDIA)
#error lamps move here only without gloss and media: use a scene of matte surfaces
#endif

// ∂/∂y_a of the direct light that the camera sees, per unit of length.
vec3 get_change_by_moved_lamps(Ray ray, inout uvec2 seed) {
    const int AXIS = MOVE_LAMPS - 1;
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    if (s.is_dielectric || !is_above_surface(s, s.out_direction)) return vec3(0.0);

    // A point of a lamp, with density P/A with respect to area. P includes that no light probe is chosen.
    if (!HAS_LIGHT_TRIANGLES || HAS_LIGHT_PROBE_CELLS && happens(LIGHT_PROBE_PROBABILITY, seed)) return vec3(0.0);
    vec2 u;
    LightTriangle light = choose_light(s, seed, u);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));
    vec3 d = y.position - s.position;
    float n_d = dot(s.normal, d), m_d = dot(y.normal, d), d_d = dot(d, d);
    if (!(m_d < 0.0) || !is_above_surface(s, d)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    // ∂G/∂y_a, multiplied out: where light grazes a surface, n·d is 0 and the logarithm infinite.
    float change = (4.0 * d[AXIS] * n_d * m_d / d_d - s.normal[AXIS] * m_d - y.normal[AXIS] * n_d) / (d_d * d_d);
    return get_brdf(s, normalize(d)) * y.emission * (change * light.inverse_density);
}
#endif
