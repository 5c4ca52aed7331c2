// Next event estimation, written with densities: estimator = f L cos / p, where p is the density of the light sample with
// respect to solid angle.

// Uniform barycentric coordinates: points in the wrong half of the parallelogram are mirrored.
vec2 uniform_barycentrics(vec2 u) { return u.x + u.y > 1.0 ? vec2(1.0) - u : u; }

vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    LightTriangle triangle = choose_light_triangle(seed);
    LightPoint lamp = get_light_point(triangle, uniform_barycentrics(get_random_numbers(seed)));

    vec3 d = lamp.position - s.position;
    float r2 = dot(d, d);
    vec3 wi = d * inversesqrt(r2);

    // We see the lamp only from its front, and only above our own horizon.
    float cos_lamp = -dot(lamp.normal, wi);
    if (cos_lamp <= 0.0) return vec3(0.0);
    if (!is_above_surface(s, wi)) return vec3(0.0);

    // area density -> solid angle density
    float p_area = 1.0 / triangle.inverse_density;
    float p_omega = p_area * r2 / cos_lamp;

    bool visible = !is_occluded(get_ray_to_point(s, lamp.position_in_front), 1.0);
    float cos_surface = dot(s.normal, wi);
    return visible ? get_brdf(s, wi) * lamp.emission * (cos_surface / p_omega) : vec3(0.0);
}
