// What every backend runs for a pixel: brings it up to the asked number of samples.
#include "constants.glsl"
#include "random.glsl"
#include "frame.glsl"
#include "camera.glsl"
#include "textures.glsl"
#include "background.glsl"
#include "shading_data.glsl"
#include "materials.glsl"
#include "lights.glsl"
#include "film.glsl"

layout(scalar, set = 0, binding = BINDING_FILM) buffer Film { FilmPixel film[]; };
layout(scalar, set = 0, binding = BINDING_RAY_COUNTERS) buffer RayCounters { uint ray_counters[]; };

// Whether light that arrives after this many bounces belongs to the picture: --only-path-length shows one length.
bool is_counted(uint path_length) {
    return parameters.only_path_length < 0 || parameters.only_path_length == int(path_length);
}

// The estimator: a chapter's path_trace.glsl.
//   vec3 path_trace(Ray ray, inout uvec2 seed) estimates the radiance L(x_0, ω_0) that arrives along a camera ray.
#include "path_trace.glsl"

void render_pixel(uint block, uvec2 offset, uint target_samples) {
    uint blocks_per_row = (parameters.image_size.x + BLOCK_WIDTH - 1u) / BLOCK_WIDTH;
    uvec2 corner = uvec2(block % blocks_per_row, block / blocks_per_row) * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT);
    uvec2 position = corner + offset;
    if (any(greaterThanEqual(position, parameters.image_size))) return;
    uint pixel_index = position.y * parameters.image_size.x + position.x;

    // L := 1/N sum of path_trace(x_0, ω_0, 0) over N samples; the division by N happens when the film is read.
    FilmPixel pixel = film[pixel_index];
    while (pixel.sample_count < target_samples) {
        uint sample_index = parameters.first_sample + pixel.sample_count;
        uvec2 seed = random_start_state(pixel_index, sample_index, parameters.seed_key);
        vec2 image_position = (vec2(position) + get_random_numbers(seed)) / vec2(parameters.image_size);
        add_sample(pixel, path_trace(get_camera_ray(image_position), seed));
    }
    film[pixel_index] = pixel;
    atomicAdd(ray_counters[pixel_index % RAY_COUNTER_COUNT], ray_count);
}
