// Chooses one of the emissive triangles and a point on it.
#ifdef FEATURE_LIGHT_TRIANGLES
int light_triangle_count() { return light_triangles.length(); }
LightTriangle light_at(uint index) { return light_triangles[index]; }
#else
int light_triangle_count() { return 1; }
LightTriangle light_at(uint index) { return LightTriangle(0u, 0u, 0u, 0u, 0.0); }
#endif
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    vec2 pick = get_random_numbers(seed);
    uint n = uint(light_triangle_count());
    LightTriangle light = light_at(min(uint(pick.x * float(n)), n - 1u));

    vec2 u = get_random_numbers(seed);
    float root = sqrt(u.x);
    LightPoint y = get_light_point(light, vec2(root - root * u.y, root * u.y));
    vec3 offset = y.position - s.position;
    float r = length(offset);
    vec3 omega = offset / r;
    float cos_y = dot(y.normal, -omega), cos_x = dot(s.normal, omega);
    if (!(cos_y > 0.0) || !is_above_surface(s, omega)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);
    return get_brdf(s, omega) * y.emission * (cos_x * cos_y / (r * r)) * light.inverse_density;
}
