// Uniform angles. The recursion of the slides as it stands there: calls wait on a stack, and the radiance is put
// together on the way back, L_{k-1} = L_{e,k} + factor · L_k.
//
// One call turns the radiance L_k that it gets into emitted + factor · L_k. Two such calls after each other are again
// of that form, so a full stack can be replaced by a single entry, and paths may have any length.
struct OpenCall {
    vec3 emitted;
    vec3 factor;
};

const uint STACK_SIZE = 12u;

OpenCall join(OpenCall outer, OpenCall inner) {
    return OpenCall(outer.emitted + outer.factor * inner.emitted, outer.factor * inner.factor);
}

OpenCall join_all(OpenCall calls[STACK_SIZE], uint count) {
    OpenCall joined = calls[count - 1u];
    for (uint i = count - 1u; i > 0u; --i) joined = join(calls[i - 1u], joined);
    return joined;
}

vec3 get_direction(float theta, float phi) {
    return vec3(sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta));
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    OpenCall calls[STACK_SIZE];
    uint count = 0u;
    uint bounces = 0u;
    while (true) {
        // The innermost call returns something without asking for L_k: its factor stays 0.
        OpenCall call = OpenCall(vec3(0.0), vec3(0.0));
        Hit hit;
        bool is_hit = trace_ray(ray, NO_LIMIT, hit);
        if (!is_hit) {
            if (is_counted(bounces)) call.emitted = get_background_radiance(ray.direction);
            calls[count++] = call;
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        if (is_counted(bounces)) call.emitted = s.emission;

        // Both angles uniform: p(θ, φ) = 1/(2π) · 2/π, and dω = sin θ dθ dφ. So 1/p(ω) = π² sin θ.
        vec2 u = get_random_numbers(seed);
        float theta = u.x * 0.5 * PI;
        float phi = u.y * 2.0 * PI;
        vec3 omega = get_shading_space(s.normal) * get_direction(theta, phi);
        bool is_scattered = is_above_surface(s, -ray.direction) && is_above_surface(s, omega);
        if (bounces < parameters.max_path_length && is_scattered) {
            vec3 brdf = get_brdf(s, omega);
            call.factor = PI * PI * sin(theta) * brdf * cos(theta);
        }
        calls[count++] = call;
        if (call.factor == vec3(0.0)) break;
        if (count == STACK_SIZE) {
            calls[0] = join_all(calls, count);
            count = 1u;
        }
        ray = get_ray_from_surface(s, omega);
        ++bounces;
    }
    return join_all(calls, count).emitted;
}
