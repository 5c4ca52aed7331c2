// The probability density, with respect to solid angle, of finding a point of the lights from here.
float solid_angle_density(LightTriangle light, float squared_distance, float cos_at_light) {
    return squared_distance / (cos_at_light * light.inverse_density);
}

vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    // A uniform point of the parallelogram, folded into the triangle.
    vec2 b = get_random_numbers(seed);
    if (b.x + b.y > 1.0) b = 1.0 - b;
    LightTriangle light = choose_light_triangle(seed);
    LightPoint y = get_light_point(light, b);

    vec3 path = y.position - s.position;
    float square = dot(path, path);
    vec3 omega = path / sqrt(square);
    float cos_at_light = -dot(y.normal, omega);
    bool is_facing = cos_at_light > 0.0 && is_above_surface(s, omega);
    if (!is_facing || is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);
    return y.emission * get_brdf(s, omega) * (dot(s.normal, omega) / solid_angle_density(light, square, cos_at_light));
}
