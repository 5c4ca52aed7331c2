// Cosine sampling by the inverse of the distribution of θ, step by step: p(θ) = 2 sin θ cos θ = sin 2θ on [0, π/2],
// P(θ) = (1 - cos 2θ) / 2, so θ = ½ acos(1 - 2u). The pole of the angles is the x-axis. The path's light is put
// together from its end, after all of its hits are known, a block of bounces at a time.
vec3 sample_about_x(vec2 u) {
    float theta = 0.5 * acos(clamp(1.0 - 2.0 * u.x, -1.0, 1.0));
    float phi = 2.0 * PI * u.y;
    return vec3(cos(theta), sin(theta) * cos(phi), sin(theta) * sin(phi));
}

// Columns: the normal first, then two tangents.
mat3 get_frame(vec3 normal) {
    vec3 axis = abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 tangent = normalize(cross(normal, axis));
    return mat3(normal, tangent, cross(normal, tangent));
}

const uint BLOCK = 8u;

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 block_throughput = vec3(1.0);  // product of the factors of all earlier blocks
    uint path_length = 0u;
    bool goes_on = true;
    while (goes_on) {
        vec3 emitted[BLOCK], factors[BLOCK];
        uint count = 0u;
        while (goes_on && count < BLOCK) {
            bool is_shown = is_counted(path_length);
            emitted[count] = vec3(0.0);
            factors[count] = vec3(0.0);
            Hit hit;
            goes_on = trace_ray(ray, NO_LIMIT, hit);
            if (!goes_on) {
                if (is_shown) emitted[count] = get_background_radiance(ray.direction);
            } else {
                ShadingData s = get_shading_data(hit, ray.direction);
                if (is_shown) emitted[count] = s.emission;
                vec3 omega = get_frame(s.normal) * sample_about_x(get_random_numbers(seed));
                goes_on = path_length < parameters.max_path_length && is_above_surface(s, omega) &&
                          is_above_surface(s, -ray.direction);
                // The cosine has cancelled against the density cos θ / π.
                if (goes_on) factors[count] = get_pi_brdf(s, omega, -ray.direction);
                if (goes_on) ray = get_ray_from_surface(s, omega);
            }
            ++path_length;
            ++count;
        }
        // L_{k-1} = L_{e,k} + factor · L_k, backwards.
        vec3 incoming = vec3(0.0);
        vec3 product = vec3(1.0);
        for (uint i = count; i-- > 0u;) {
            incoming = emitted[i] + factors[i] * incoming;
            product *= factors[i];
        }
        radiance += block_throughput * incoming;
        block_throughput *= product;
    }
    return radiance;
}
