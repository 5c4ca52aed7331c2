#version 460
// Each invocation writes one point of a sampler, as COLUMNS numbers. A define chooses the sampler. Points of a pixel are those of
// samples of even index, which belong together where samples depend on each other.
#ifdef LIGHT_POINTS
#define FEATURE_LIGHT_TRIANGLES
#endif
#ifdef LENS_POINTS
#define FEATURE_LENS
#endif
#include "observation/estimator_stub.glsl"

layout(scalar, binding = 0) writeonly buffer Results { float results[]; };
layout(scalar, binding = 1) readonly buffer Inputs {
    uvec2 key;             // of the random start states
    uint max_path_length;  // 1; set_surface() says why it is no constant
    uint samples;          // of each pixel
    LightTriangle light_triangles[1];
};

#if defined(DIRECTIONS) || defined(LIGHT_POINTS)
#include "world/lights.glsl"
bool is_occluded(Ray ray, float t_max) { return false; }

// Records the point on the light that the estimator chooses.
vec2 light_barycentrics;
LightPoint get_and_note_light_point(LightTriangle light, vec2 barycentrics) {
    light_barycentrics = barycentrics;
    return get_light_point(light, barycentrics);
}
#define get_light_point get_and_note_light_point
#include "path_trace.glsl"
#endif

#if defined(DIRECTIONS) || defined(LIGHT_POINTS)
// Runs the estimator on a white floor below a white sky.
vec3 run_estimator(uvec2 seed) {
    Material white = Material(vec3(1.0), -1, vec3(0.0), 0.0, vec3(0.0), 0.0, vec3(0.0), 0.0);
    set_surface(vec3(0.0, 0.0, 1.0), white, max_path_length);
    // The light triangle that lights.glsl looks up: it is above the floor and faces it.
    positions[3] = vec3(0.0, 0.0, 1.0);
    positions[4] = vec3(0.0, 1.0, 1.0);
    positions[5] = vec3(1.0, 0.0, 1.0);
    materials[1] = white;
    return path_trace(Ray(vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, -1.0)), seed);
}
#endif

#if defined(DIRECTIONS)
// A direction and its weight, all 0 if the estimator traces no direction.
void write_point(uint i, uvec2 seed) {
    float weight = run_estimator(seed).r;
    vec3 direction = ray_count == 2u ? traced_direction : vec3(0.0);
    for (int axis = 0; axis < 3; ++axis) results[COLUMNS * i + axis] = direction[axis];
    results[COLUMNS * i + 3u] = weight;
}
#elif defined(LIGHT_POINTS)
// The barycentric coordinates w_1 and w_2.
void write_point(uint i, uvec2 seed) {
    run_estimator(seed);
    for (int axis = 0; axis < 2; ++axis) results[COLUMNS * i + axis] = light_barycentrics[axis];
}
#elif defined(LENS_POINTS)
#include "camera.glsl"
// A point of the aperture of radius 1: where a camera ray starts.
void write_point(uint i, uvec2 seed) {
    parameters.image_size = uvec2(1u);
    parameters.camera = Camera(vec3(0.0), vec3(0.0, 0.0, -1.0), vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), 1.0, 1.0);
    vec2 point = sample_camera_ray(uvec2(0u), seed).origin.xy;
    for (int axis = 0; axis < 2; ++axis) results[COLUMNS * i + axis] = point[axis];
}
#elif defined(BLOG_HASH)
// The hash that the blog uses for random numbers, at hit points on a floor: rows of 256 with a distance of 0.02.
float hash(vec3 p) { return fract(sin(dot(p, vec3(12.9898, 78.233, 45.164))) * 43758.5453123); }
void write_point(uint i, uvec2 seed) {
    vec3 position = 0.02 * vec3(i % 256u, 0.0, i / 256u);
    results[COLUMNS * i] = hash(position);
    results[COLUMNS * i + 1u] = hash(position + vec3(1.0, 0.0, 0.0));
}
#elif defined(SOBOL)
// Sobol's points without scrambling.
void write_point(uint i, uvec2 seed) {
    vec2 point = to_numbers(bitfieldReverse(uvec2(i % samples, get_second_dimension(i % samples))));
    for (int axis = 0; axis < 2; ++axis) results[COLUMNS * i + axis] = point[axis];
}
#else
// The first random numbers of a path.
void write_point(uint i, uvec2 seed) {
    for (uint column = 0u; column < COLUMNS; column += 2u) {
        vec2 u = get_random_numbers(seed);
        results[COLUMNS * i + column] = u.x;
        if (column + 1u < COLUMNS) results[COLUMNS * i + column + 1u] = u.y;
    }
}
#endif

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (COLUMNS * i < results.length()) write_point(i, random_start_state(i / samples, 2u * (i % samples), key));
}
