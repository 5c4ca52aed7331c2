// Direct light by area sampling.
vec3 sample_point(vec2 u) {
    // barycentric coordinates of a random point of the triangle
    float a = u.x * (1.0 - u.y), b = u.x * u.y;
    return vec3(1.0 - a - b, a, b);
}

vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    LightTriangle light = choose_light_triangle(seed);
    vec3 w = sample_point(get_random_numbers(seed));
    LightPoint y = get_light_point(light, w.yz);

    vec3 d = y.position - s.position;
    float d2 = dot(d, d);
    vec3 wi = d * inversesqrt(d2);
    float cosine_y = -dot(y.normal, wi);
    if (cosine_y <= 0.0 || !is_above_surface(s, wi)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    float pdf = d2 / (cosine_y * light.inverse_density);
    return y.emission * get_brdf(s, wi) * dot(s.normal, wi) / pdf;
}
