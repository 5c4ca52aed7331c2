// Counts shadow rays from visible points to random points on the lights: red counts blocked ones, green all that leave above the
// surface and reach the front of a light.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return vec3(0.0);
    ShadingData s = get_shading_data(hit, ray.direction);
    LightTriangle light = choose_light_triangle(seed);
    vec2 u = get_random_numbers(seed);
    LightPoint y = get_light_point(light, vec2(sqrt(u.x) * (1.0 - u.y), sqrt(u.x) * u.y));
    vec3 omega = normalize(y.position - s.position);
    if (!(dot(y.normal, -omega) > 0.0) || !is_above_surface(s, omega)) return vec3(0.0);
    return vec3(is_occluded(get_ray_to_point(s, y.position_in_front), 1.0), 1.0, 0.0);
}
