// The loop of chapter 10 for camera paths, and before it the same one for light paths: in one loop, threads on the way from the lamp
// would wait for those on the way from the camera.
#ifndef SPLATS
#include "10_path_regeneration/sample_loop.glsl"
#else
#include "light_path.glsl"

// As many light paths as camera paths.
void trace_light_paths(uvec2 position, uint first, uint end, uint step) {
    LightPath path;
    uvec2 seed;
    bool is_alive = false;
    for (uint i = first; is_alive || i < end;) {
        if (!is_alive) {
            start_sample(position, i, seed);
            path = start_light_path(i, seed);
            i += step;
        }
        is_alive = extend_light_path(path, seed);
    }
}

// The samples of a pixel: first all light paths, then all camera paths.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    trace_light_paths(position, first, end, step);
    Path path;
    uvec2 seed;
    bool is_alive = false;
    for (uint i = first; is_alive || i < end;) {
        if (!is_alive) {
            path = start_path(start_sample(position, i, seed));
            starts_matte = false;
        }
        is_alive = extend_path(path, seed);
        if (path.path_length == 1u) starts_matte = path.receiver.is_light_sampled;
        if (is_alive) continue;
        finish_sample(path.radiance);
        i += step;
    }
}
#endif
