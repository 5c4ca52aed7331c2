// Path regeneration. `next` is the index of the sample that this thread starts when it has nothing to do.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    uint next = first;
    bool busy = false;
    uvec2 rng;
    Path path;

    while (busy || next < end) {
        if (!busy) {
            Ray camera_ray = start_sample(position, next, rng);
            path = start_path(camera_ray);
            next += step;
        }

        busy = extend_path(path, rng);
        if (!busy) finish_sample(path.radiance);
    }
}
