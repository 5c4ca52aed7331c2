// What every backend runs for a pixel: renders its samples up to the requested number, or this thread's share of them.
#include "world/constants.glsl"
#include "world/random.glsl"
#include "world/frame.glsl"
#include "world/camera.glsl"
#include "world/textures.glsl"
#include "world/light_probe.glsl"
#include "world/background.glsl"
#include "world/shading_data.glsl"
#include "world/materials.glsl"
#include "world/lights.glsl"
#include "blocks.glsl"
#include "film.glsl"

layout(scalar, set = 0, binding = BINDING_FILM) buffer Film { FilmPixel film[]; };
layout(scalar, set = 0, binding = BINDING_RAY_COUNTERS) buffer RayCounters { uint ray_counters[]; };
#ifdef SHARED_PIXELS
layout(scalar, set = 0, binding = BINDING_SAMPLES) writeonly buffer Samples { vec3 samples[]; };
#endif

// Whether light that arrives after this many bounces belongs to the picture: --only-path-length shows a single length.
bool is_counted(uint path_length) {
    return parameters.only_path_length < 0 || parameters.only_path_length == int(path_length);
}

// The estimator, a chapter's path_trace.glsl:
//   vec3 path_trace(Ray ray, inout uvec2 seed) estimates the radiance L(x_0, ω_0) that arrives along a camera ray.
#include "path_trace.glsl"

// The camera ray through a random point of a pixel, for the sample of this index, and the state of its random numbers.
Ray start_sample(uvec2 position, uint index, out uvec2 seed) {
    uint pixel_index = position.y * parameters.image_size.x + position.x;
    seed = random_start_state(pixel_index, parameters.first_sample + index, parameters.seed_key);
    vec2 image_position = (vec2(position) + get_random_numbers(seed)) / vec2(parameters.image_size);
    return get_camera_ray(image_position);
}

// The pixel of this thread stays in memory: kept in registers, its eleven numbers would be saved around every call that
// traces a ray. Where several threads share it, they store their samples, and add_samples.comp adds them in the order of
// their indices.
uint film_index;
uint sample_place, sample_stride;
void finish_sample(vec3 radiance) {
#ifdef SHARED_PIXELS
    samples[sample_place] = radiance;
    sample_place += sample_stride;
#else
    add_sample(film[film_index], radiance);
#endif
}

// void render_samples(uvec2 position, uint first, uint end, uint step)
#include "sample_loop.glsl"

// Invocations of a dispatch are numbered: first the pixels of a block, then the other threads that share these pixels, then
// the next block.
void render_pixel(uint invocation) {
    uint group = invocation / BLOCK_SIZE;
    uint index = invocation % BLOCK_SIZE;
    uint block = group / dispatch.threads_per_pixel;
    uvec2 position = get_pixel_position(dispatch.first_block + block, index, parameters.image_size);
    if (any(greaterThanEqual(position, parameters.image_size))) return;
#ifdef ONLY_PIXEL  // that a debugger looks at
    if (position != ONLY_PIXEL) return;
#endif
    uint pixel_index = position.y * parameters.image_size.x + position.x;
    film_index = pixel_index - dispatch.first_film_pixel;

    // L := 1/N sum of path_trace(x_0, ω_0, 0) over N samples. The film is divided by N when it is read.
    uint first = film[film_index].sample_count;
#ifdef SHARED_PIXELS
    uint turn = group % dispatch.threads_per_pixel;
    sample_place = (block * dispatch.samples_per_pixel + turn) * BLOCK_SIZE + index;
    sample_stride = dispatch.threads_per_pixel * BLOCK_SIZE;
    render_samples(position, first + turn, dispatch.target_samples, dispatch.threads_per_pixel);
#else
    render_samples(position, first, dispatch.target_samples, 1u);
#endif
    atomicAdd(ray_counters[pixel_index % RAY_COUNTER_COUNT], ray_count);
}
