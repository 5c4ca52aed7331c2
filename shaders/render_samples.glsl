// What every backend runs for a pixel: brings it up to the asked number of samples, or does its share of them.
#include "constants.glsl"
#include "random.glsl"
#include "frame.glsl"
#include "camera.glsl"
#include "textures.glsl"
#include "light_probe.glsl"
#include "background.glsl"
#include "shading_data.glsl"
#include "materials.glsl"
#include "lights.glsl"
#include "blocks.glsl"
#include "film.glsl"

layout(scalar, set = 0, binding = BINDING_FILM) buffer Film { FilmPixel film[]; };
layout(scalar, set = 0, binding = BINDING_RAY_COUNTERS) buffer RayCounters { uint ray_counters[]; };
#ifdef SHARED_PIXELS
layout(scalar, set = 0, binding = BINDING_SAMPLES) writeonly buffer Samples { vec3 samples[]; };
#endif

// Whether light that arrives after this many bounces belongs to the picture: --only-path-length shows one length.
bool is_counted(uint path_length) {
    return parameters.only_path_length < 0 || parameters.only_path_length == int(path_length);
}

// The estimator: a chapter's path_trace.glsl.
//   vec3 path_trace(Ray ray, inout uvec2 seed) estimates the radiance L(x_0, ω_0) that arrives along a camera ray.
// With PATH_REGENERATION, which chapter 10 defines, it does the same bounce by bounce.
#include "path_trace.glsl"
#ifndef PATH_REGENERATION
// Other names stand behind these, so that a chapter may have a Path of its own.
#define Path WholePath
#define start_path start_whole_path
#define extend_path trace_whole_path
struct Path {
    Ray ray;
    vec3 radiance;
};
Path start_path(Ray ray) { return Path(ray, vec3(0.0)); }

// Returns whether the path goes on. All of it is done at once here.
bool extend_path(inout Path path, inout uvec2 seed) {
    path.radiance = path_trace(path.ray, seed);
    return false;
}
#endif

// The camera ray of a sample of a pixel, which has so many before it, and the state of its random numbers.
Ray start_sample(uvec2 position, uint pixel_index, uint sample_count, out uvec2 seed) {
    uint sample_index = parameters.first_sample + sample_count;
    seed = random_start_state(pixel_index, sample_index, parameters.seed_key);
    vec2 image_position = (vec2(position) + get_random_numbers(seed)) / vec2(parameters.image_size);
    return get_camera_ray(image_position);
}

// Invocations of a dispatch are numbered: first the pixels of a block, then the next threads of the same pixels, then the
// next block.
void render_samples(uint invocation) {
    uint group = invocation / BLOCK_SIZE;
    uint index = invocation % BLOCK_SIZE;
    uint block = group / dispatch.threads_per_pixel;
    uvec2 position = get_pixel_position(dispatch.first_block + block, index, parameters.image_size);
    if (any(greaterThanEqual(position, parameters.image_size))) return;
    uint pixel_index = position.y * parameters.image_size.x + position.x;
    uint film_index = pixel_index - dispatch.first_film_pixel;

    // L := 1/N sum of path_trace(x_0, ω_0, 0) over N samples; the division by N happens when the film is read.
    FilmPixel pixel = film[film_index];
    uint sample_count = pixel.sample_count, step = 1u;
#ifdef SHARED_PIXELS
    // The threads of a pixel render its samples in turns; add_samples.comp adds them up in the order of their indices.
    uint place = block * dispatch.samples_per_pixel + group % dispatch.threads_per_pixel;
    sample_count += group % dispatch.threads_per_pixel;
    step = dispatch.threads_per_pixel;
#endif
    // One loop over samples and bounces: a thread whose path has ended starts its next one, whatever its neighbours do.
    Path path;
    uvec2 seed;
    bool is_path_alive = false;
    while (is_path_alive || sample_count < dispatch.target_samples) {
        if (!is_path_alive) path = start_path(start_sample(position, pixel_index, sample_count, seed));
        is_path_alive = extend_path(path, seed);
        if (is_path_alive) continue;
#ifdef SHARED_PIXELS
        samples[place * BLOCK_SIZE + index] = path.radiance;
        place += step;
#else
        add_sample(pixel, path.radiance);
#endif
        sample_count += step;
    }
#ifndef SHARED_PIXELS
    film[film_index] = pixel;
#endif
    atomicAdd(ray_counters[pixel_index % RAY_COUNTER_COUNT], ray_count);
}
