// Light sample by Anna. Folds the unit square over its diagonal, so that the point is uniform on the triangle.
vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    LightTriangle tri = choose_light_triangle(seed);
    vec2 b = get_random_numbers(seed);
    if (b.x + b.y > 1.0) b = vec2(1.0) - b;
    LightPoint p = get_light_point(tri, b);

    vec3 d = p.position - s.position;
    float d2 = dot(d, d);
    vec3 wi = d * inversesqrt(d2);

    // G = cos_s * cos_l / d^2
    float cos_s = dot(s.normal, wi);
    float cos_l = -dot(p.normal, wi);
    vec3 result = vec3(0.0);
    if (cos_l > 0.0 && is_above_surface(s, wi)) {
        Ray shadow = get_ray_to_point(s, p.position_in_front);
        if (!is_occluded(shadow, 1.0)) {
            float pdf_area = 1.0 / tri.inverse_density;
            result = p.emission * get_brdf(s, wi) * (cos_s * cos_l / d2) / pdf_area;
        }
    }
    return result;
}
