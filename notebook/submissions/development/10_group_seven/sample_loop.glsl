// Group 7: one loop for samples and bounces. A thread whose path has ended goes back to the camera.

Path new_path(Ray camera_ray) {
    Path p;
    p.ray = camera_ray;
    p.radiance = vec3(0.0);
    p.throughput = vec3(1.0);
    p.path_length = 0u;
    p.radiance_scale = 1.0;
    p.receiver.is_light_sampled = STRATEGY != STRATEGY_BOUNCES;
    p.bounce_density = 1.0;  // the camera ray has no choice
    return p;
}

void render_samples(uvec2 position, uint first, uint end, uint step) {
    if (first >= end) return;
    uint i = first;
    uvec2 seed;
    Path path = new_path(start_sample(position, i, seed));
    while (i < end) {
        bool goes_on = extend_path(path, seed);
        if (!goes_on) {
            finish_sample(path.radiance);
            i += step;
            if (i < end) path = new_path(start_sample(position, i, seed));
        }
    }
}
