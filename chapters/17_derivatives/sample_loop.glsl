#include "move_lamps.glsl"

#if MOVE_LAMPS > 0
// One loop over samples, each of which adds how the lamps' position changes its direct light.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    for (uint i = first; i < end; i += step) {
        uvec2 seed;
        Ray ray = start_sample(position, i, seed);
        finish_sample(get_change_by_moved_lamps(ray, seed));
    }
}
#else
// The loop of chapter 10, which adds the derivative of a path's light to the pixel if one is asked for.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    Path path;
    uvec2 seed;
    bool is_alive = false;
    for (uint i = first; is_alive || i < end;) {
        if (!is_alive) {
            path = start_path(start_sample(position, i, seed));
            start_counting();
        }
        is_alive = extend_path(path, seed);
        if (is_alive) continue;
        finish_sample(DERIVATIVE == NO_MATERIAL ? path.radiance : get_derivative(path.radiance));
        i += step;
    }
}
#endif
