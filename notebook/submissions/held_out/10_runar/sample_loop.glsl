// One loop over samples and bounces: a thread whose path has ended starts its next sample, whatever its neighbours do.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    Path path;
    uvec2 seed;
    bool is_alive = false;
    for (uint i = first; is_alive || i < end;) {
        if (!is_alive) path = start_path(start_sample(position, i, seed));
        is_alive = extend_path(path, seed);
        if (is_alive) continue;
        finish_sample(min(path.radiance, vec3(1.0)));  // what the screen can show
        i += step;
    }
}
