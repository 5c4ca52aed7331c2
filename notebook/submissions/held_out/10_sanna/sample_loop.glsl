// One loop. The random generator of the thread runs on from sample to sample.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    if (first >= end) return;
    uvec2 seed;
    Path path = start_path(start_sample(position, first, seed));
    for (uint i = first; i < end;) {
        bool alive = extend_path(path, seed);
        if (!alive) {
            finish_sample(path.radiance);
            i += step;
            uvec2 camera_seed;
            if (i < end) path = start_path(start_sample(position, i, camera_seed));
        }
    }
}
