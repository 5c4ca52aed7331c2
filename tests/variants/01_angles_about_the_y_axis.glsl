// Uniform angles with the y-axis as pole, a frame by cross products, and the weight as the general formula
// f cos θ / p with an explicit density.
struct DirectionSample {
    vec3 direction;
    float density;  // with respect to solid angle; 0 at the pole itself, where it would be infinite
};

DirectionSample sample_angles(vec3 normal, vec2 u) {
    float azimuth = 2.0 * PI * u.x;
    float inclination = 0.5 * PI * (1.0 - u.y);  // from the horizon to the pole
    // Any vector that is not parallel to the normal gives two tangents.
    vec3 helper = abs(normal.x) < 0.5 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 0.0, 1.0);
    vec3 tangent = normalize(cross(helper, normal));
    vec3 bitangent = cross(normal, tangent);
    vec3 local = vec3(sin(inclination) * cos(azimuth), cos(inclination), sin(inclination) * sin(azimuth));
    vec3 direction = local.x * tangent + local.y * normal + local.z * bitangent;
    // The square has density 1, the angles 1/π², the solid angle of dθ dφ is sin θ dθ dφ.
    float sine = sin(inclination);
    return DirectionSample(direction, sine > 0.0 ? 1.0 / (PI * PI * sine) : 0.0);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 sum = vec3(0.0);
    vec3 beta = vec3(1.0);
    for (uint k = 1u; k <= parameters.max_path_length + 1u; ++k) {  // as on the slides: x_k is hit next
        Hit hit;
        bool has_missed = !trace_ray(ray, NO_LIMIT, hit);
        ShadingData s;
        vec3 emitted;
        if (has_missed) {
            emitted = get_background_radiance(ray.direction);
        } else {
            s = get_shading_data(hit, ray.direction);
            emitted = s.emission;
        }
        if (is_counted(k - 1u)) sum += beta * emitted;
        if (has_missed) return sum;

        DirectionSample next = sample_angles(s.normal, get_random_numbers(seed));
        if (next.density == 0.0) return sum;  // straight up: sin θ = 0 is its weight
        if (!is_above_surface(s, -ray.direction)) return sum;
        if (!is_above_surface(s, next.direction)) return sum;
        float cos_theta = dot(s.normal, next.direction);
        beta *= get_pi_brdf(s, next.direction, -ray.direction) / PI * cos_theta / next.density;
        ray = get_ray_from_surface(s, next.direction);
    }
    return sum;
}
