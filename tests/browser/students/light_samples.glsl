// a real direct light estimator with arrays of samples, multiple per hit
vec3 path_trace(Ray ray, inout uvec2 seed) {
    Hit hit;
    if (!trace_ray(ray, NO_LIMIT, hit)) return get_background_radiance(ray.direction);
    ShadingData s = get_shading_data(hit, ray.direction);
    vec3 samples[2];
    for (int i = 0; i < 2; ++i) {
        vec2 film = get_random_numbers(seed);
        LightTriangle light = choose_light_triangle(seed);
        LightPoint y = get_light_point(light, film.x + film.y > 1.0 ? 1.0 - film : film);
        vec3 d = y.position_in_front - s.position;
        float r2 = dot(d, d);
        samples[i] = max(dot(s.normal, d) * dot(y.normal, -d), 0.0) / (r2 * r2) * y.emission * s.diffuse_albedo / y.light_density;
    }
    return s.emission + 0.5 * (samples[0] + samples[1]);
}
