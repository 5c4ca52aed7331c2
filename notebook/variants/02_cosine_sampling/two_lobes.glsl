// Cosine sampling of the diffuse part and sampling of the Phong lobe about the mirror direction: one of them is
// chosen, and the weight is f cos θ over the density of both together. On surfaces without a lobe it is π ρ.
//
// Directions of the cosine's density: cos θ is the larger of two uniform numbers, for P(max < c) = c².
vec3 sample_cosine(vec2 u, float azimuth_number) {
    float cos_theta = max(u.x, u.y);
    float sin_theta = sqrt(1.0 - cos_theta * cos_theta);
    float phi = 2.0 * PI * azimuth_number;
    return vec3(sin_theta * cos(phi), sin_theta * sin(phi), cos_theta);
}

#ifdef FEATURE_SPECULAR
// Density (n+1)/(2π) cos^n α about the mirror direction.
vec3 sample_lobe(vec2 u, float exponent) {
    float cos_alpha = pow(1.0 - u.x, 1.0 / (exponent + 1.0));
    float sin_alpha = sqrt(max(1.0 - cos_alpha * cos_alpha, 0.0));
    return vec3(sin_alpha * cos(2.0 * PI * u.y), sin_alpha * sin(2.0 * PI * u.y), cos_alpha);
}
#endif

// Probability of the lobe: its share of the albedo, but never all.
float get_lobe_probability(ShadingData s) {
#ifdef FEATURE_SPECULAR
    float lobe = max_component(s.specular_albedo);
    return lobe > 0.0 ? 0.9 * lobe / (lobe + max_component(s.diffuse_albedo)) : 0.0;
#else
    return 0.0;
#endif
}

// Direction, and f cos θ over its density. `weight` is 0 where the light would come from below.
vec3 sample_direction(ShadingData s, vec3 out_direction, inout uvec2 seed, out vec3 weight) {
    float lobe_probability = get_lobe_probability(s);
    vec2 u = get_random_numbers(seed);
    vec2 v = get_random_numbers(seed);
    vec3 omega = get_shading_space(s.normal) * sample_cosine(u, v.x);
#ifdef FEATURE_SPECULAR
    vec3 mirrored = reflect(-out_direction, s.normal);
    if (v.y < lobe_probability) omega = get_shading_space(mirrored) * sample_lobe(u, s.specular_exponent);
#endif
    weight = vec3(0.0);
    if (!is_above_surface(s, omega) || !is_above_surface(s, out_direction)) return omega;

    float cos_theta = dot(s.normal, omega);
    float density_over_cosine = (1.0 - lobe_probability) / PI;
#ifdef FEATURE_SPECULAR
    float cos_alpha = clamp(dot(mirrored, omega), 0.0, 1.0);
    float lobe = cos_alpha > 0.0 ? pow(cos_alpha, s.specular_exponent) : 0.0;
    density_over_cosine += lobe_probability * (s.specular_exponent + 1.0) / (2.0 * PI) * lobe / cos_theta;
#endif
    weight = get_brdf(s, omega) / density_over_cosine;
    return omega;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    for (uint path_length = 0u;; ++path_length) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(path_length)) radiance += throughput * get_background_radiance(ray.direction);
            return radiance;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(path_length)) radiance += throughput * s.emission;
        if (path_length == parameters.max_path_length) return radiance;

        vec3 weight;
        vec3 omega = sample_direction(s, -ray.direction, seed, weight);
        if (weight == vec3(0.0)) return radiance;
        throughput *= weight;
        ray = get_ray_from_surface(s, omega);
    }
}
