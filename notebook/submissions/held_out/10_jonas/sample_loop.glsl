// Regeneration: when a path ends, the thread takes the next sample. No path may hold up its group for long.
const uint MOST_BOUNCES = 5u;

void render_samples(uvec2 position, uint first, uint end, uint step) {
    uvec2 seed;
    Path path;
    bool is_alive = false;
    uint i = first;
    while (is_alive || i < end) {
        if (!is_alive) path = start_path(start_sample(position, i, seed));

        is_alive = extend_path(path, seed);
        if (path.path_length == MOST_BOUNCES) is_alive = false;

        if (!is_alive) {
            finish_sample(path.radiance);
            i += step;
        }
    }
}
