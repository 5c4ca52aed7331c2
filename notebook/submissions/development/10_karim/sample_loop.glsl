// Regeneration of paths: what matters is that each thread has a path that brings something.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    uvec2 seed;
    Path path;
    bool has_path = false;
    uint i = first;
    while (has_path || i < end) {
        if (!has_path) {
            path = start_path(start_sample(position, i, seed));
            i += step;
        }
        has_path = extend_path(path, seed);
        // Dim paths are not worth the wait, the thread is better off with its next sample.
        if (max_component(path.throughput) < 0.4) has_path = false;
        if (!has_path) finish_sample(path.radiance);
    }
}
