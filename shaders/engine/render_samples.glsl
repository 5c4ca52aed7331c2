// What all backends run for a pixel: brings it to the requested number of samples, or renders this thread's share of them.

// Numbers of rays. Behind them is the place of a loop that does not end, or 0.
layout(scalar, set = 0, binding = BINDING_RAY_COUNTERS) buffer RayCounters { uint ray_counters[]; };
#ifdef LIMITED_LOOPS
#include "limited_loops.glsl"
#endif
#include "world/constants.glsl"
#include "world/random.glsl"
#include "world/frame.glsl"
#include "camera.glsl"
#include "world/textures.glsl"
#include "world/light_probe.glsl"
#include "world/background.glsl"
#include "world/shading_data.glsl"
#include "world/materials.glsl"
#include "world/lights.glsl"
#ifdef FEATURE_MEDIA
#include "world/boundaries.glsl"
#endif
#include "blocks.glsl"
#include "film.glsl"

layout(scalar, set = 0, binding = BINDING_FILM) buffer Film { FilmPixel film[]; };
#ifdef SHARED_PIXELS
layout(scalar, set = 0, binding = BINDING_SAMPLES) writeonly buffer Samples { vec3 samples[]; };
#endif

#ifdef SPLATS
#include "splats.glsl"
#endif

// Whether light with this many bounces counts: --only-path-length keeps a single length.
bool is_counted(uint path_length) {
    return parameters.only_path_length < 0 || parameters.only_path_length == int(path_length);
}

// The estimator, a chapter's path_trace.glsl:
//   vec3 path_trace(Ray ray, inout uvec2 seed) estimates the radiance L(x_0, ω_0) that arrives along a camera ray.
#include "path_trace.glsl"

// Generates the camera ray through a random point of the pixel for the sample with this index, and seeds its random numbers.
Ray start_sample(uvec2 position, uint index, out uvec2 seed) {
#ifdef LIMITED_LOOPS
    start_counting_iterations();
#endif
    uint pixel_index = position.y * parameters.image_size.x + position.x;
    seed = random_start_state(pixel_index, parameters.first_sample + index, parameters.seed_key);
    return sample_camera_ray(position, seed);
}

// This thread's pixel stays in memory: kept in registers, its eleven numbers would be spilled around every call that traces
// a ray. Threads that share a pixel store their samples one by one, and add_samples.comp adds them to the film in index
// order.
uint film_index;
uint sample_place, sample_stride;
// Adds the radiance of a finished sample to this thread's pixel.
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

// Numbering of invocations: the pixels of a block come first, then the further threads that share these pixels, then the next
// block.
void render_pixel(uint invocation) {
    uint group = invocation / BLOCK_SIZE;
    uint index = invocation % BLOCK_SIZE;
    uint block = group / dispatch.threads_per_pixel;
    uvec2 position = get_pixel_position(dispatch.first_block + block, index, parameters.image_size);
    if (any(greaterThanEqual(position, parameters.image_size))) return;
#ifdef ONLY_PIXEL  // the one that a debugger inspects
    if (position != ONLY_PIXEL) return;
#endif
    uint pixel_index = position.y * parameters.image_size.x + position.x;
    film_index = pixel_index - dispatch.first_film_pixel;

    // L := 1/N sum of path_trace(x_0, ω_0, 0) over N samples. The film is divided by N when it is read.
    uint first = film[film_index].sample_count;
#ifdef LIMITED_LOOPS
    samples_with_own_loops = (dispatch.target_samples - first) / dispatch.threads_per_pixel + 1u;
#ifdef SPLATS
    samples_with_own_loops *= 2u;  // a light path and a camera path
#endif
#endif
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
