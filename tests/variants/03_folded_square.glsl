// Next event estimation. The point on the light's triangle by folding the square along its diagonal; the geometry
// term from the vector between the points, without any normalisation: each cosine brings one 1/r.
#include "sampling.glsl"

vec2 fold(vec2 u) { return u.x + u.y > 1.0 ? vec2(1.0) - u : u; }

// Radiance that s reflects towards `eye` from one point of the lights.
vec3 get_light_from_lamps(ShadingData s, vec3 eye, inout uvec2 seed) {
    LightTriangle lamp = choose_light_triangle(seed);
    // The two halves of the parallelogram are congruent, so the folded point is uniform on the triangle.
    LightPoint y = get_light_point(lamp, fold(get_random_numbers(seed)));

    vec3 connection = y.position - s.position;
    float surface_side = dot(connection, s.normal);  // r cos θ
    float lamp_side = -dot(connection, y.normal);    // r cos θ'
    float square = dot(connection, connection);      // r²
    if (lamp_side <= 0.0) return vec3(0.0);          // lamps are dark on their back
    vec3 omega = connection * inversesqrt(square);
    if (!is_above_surface(s, omega)) return vec3(0.0);
    if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);

    float geometry = surface_side * lamp_side / (square * square);
    vec3 brdf = get_pi_brdf(s, omega, eye) / PI;
    return y.emission * brdf * geometry * lamp.inverse_density;
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.0);
    vec3 throughput = vec3(1.0);
    // Emission counts at the camera, and everywhere if nobody samples the lamps.
    bool takes_emission = true;
    uint bounces = 0u;
    while (true) {
        Hit hit;
        if (!trace_ray(ray, NO_LIMIT, hit)) {
            if (is_counted(bounces)) radiance += throughput * get_background_radiance(ray.direction);
            break;
        }
        ShadingData s = get_shading_data(hit, ray.direction);
        vec3 eye = -ray.direction;
        if (takes_emission && is_counted(bounces)) radiance += throughput * s.emission;
        takes_emission = !LIGHT_SAMPLING;
        if (bounces == parameters.max_path_length || !is_above_surface(s, eye)) break;
        ++bounces;

        if (LIGHT_SAMPLING) {
            vec3 from_lamps = get_light_from_lamps(s, eye, seed);
            if (is_counted(bounces)) radiance += throughput * from_lamps;
            // Only the sky could still be found.
            if (bounces == parameters.max_path_length && !HAS_BACKGROUND) break;
        }

        vec3 omega = get_shading_space(s.normal) * sample_hemisphere(get_random_numbers(seed));
        if (!is_above_surface(s, omega)) break;
        throughput *= get_pi_brdf(s, omega, eye);
        ray = get_ray_from_surface(s, omega);
    }
    return radiance;
}
