// A thread starts its next sample as soon as its path has ended.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    Path path;
    uvec2 seed;
    bool is_alive = false;
    uint i = first;

    while (i < end) {
        if (!is_alive) {
            path = start_path(start_sample(position, i, seed));
            i += step;
        }
        is_alive = extend_path(path, seed);
        if (!is_alive) finish_sample(path.radiance);
    }

    // all samples have been started: store the one that is still under way
    if (is_alive) finish_sample(path.radiance);
}
