// next event estimation: one point on the lights

vec3 sample_direct_light(ShadingData s, inout uvec2 seed) {
    // point on the light
    LightTriangle light = choose_light_triangle(seed);
    vec2 xi = get_random_numbers(seed);
    float root = sqrt(xi.x);
    LightPoint y = get_light_point(light, vec2(root * (1.0 - xi.y), root * xi.y));

    // direction to it
    vec3 v = y.position - s.position;
    float r = length(v);
    vec3 w = normalize(v);

    float cos_surface = dot(s.normal, w);
    float cos_lamp = dot(y.normal, -w);
    if (cos_lamp <= 0.0) return vec3(0.0);
    if (!is_above_surface(s, w)) return vec3(0.0);

    // shadow ray, 1.0 is the point on the light
    if (is_occluded(get_ray_from_surface(s, w), 1.0)) return vec3(0.0);

    vec3 f = get_brdf(s, w);
    return y.emission * f * cos_surface * cos_lamp * light.inverse_density / (r * r);
}
