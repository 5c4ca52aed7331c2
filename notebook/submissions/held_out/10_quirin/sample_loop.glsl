// Paths are regenerated in place.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    uint i = first;
    if (i >= end) return;
    uvec2 seed;
    Path path = start_path(start_sample(position, i, seed));
    while (true) {
        if (extend_path(path, seed)) continue;
        finish_sample(path.radiance);
        i += step;
        if (i >= end) return;
        // the next sample
        path.ray = start_sample(position, i, seed);
        path.radiance = vec3(0.0);
        path.throughput = vec3(1.0);
        path.radiance_scale = 1.0;
        path.receiver = NO_RECEIVER;
        path.bounce_density = 0.0;
    }
}
