// The loop of chapter 10, and for each sample a light path besides the camera's path.
#ifndef SPLATS
#include "10_path_regeneration/sample_loop.glsl"
#else
#include "light_path.glsl"

void render_samples(uvec2 position, uint first, uint end, uint step) {
    Path path;
    uvec2 seed;
    bool is_alive = false;
    for (uint i = first; is_alive || i < end;) {
        if (!is_alive) {
            path = start_path(start_sample(position, i, seed));
            starts_matte = false;
            trace_light_path(seed);
        }
        is_alive = extend_path(path, seed);
        if (path.path_length == 1u) starts_matte = path.receiver.is_light_sampled;
        if (is_alive) continue;
        finish_sample(path.radiance);
        i += step;
    }
}
#endif
