// Path regeneration, Rosa. A small machine: "next" says whether a new camera ray is due, every turn makes one bounce.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    if (first >= end) return;
    uint remaining = (end - first + step - 1u) / step;  // samples of this thread
    uint index = first;

    uvec2 seed;
    Path path;
    bool next = true;
    do {
        if (next) {
            Ray camera_ray = start_sample(position, index, seed);
            path = start_path(camera_ray);
            index += step;
        }
        next = !extend_path(path, seed);
        if (next) {
            finish_sample(path.radiance);
            --remaining;
        }
    } while (remaining > 0u);
}
