// The same loop with the start of the next path at its end: a path is always alive when the loop begins a turn.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    if (first >= end) return;
    uint current = first;
    uvec2 numbers;
    Ray camera_ray = start_sample(position, current, numbers);
    Path carried = start_path(camera_ray);
    do {
        bool has_ended = !extend_path(carried, numbers);
        if (has_ended) {
            finish_sample(carried.radiance);
            current += step;
            if (current < end) {
                camera_ray = start_sample(position, current, numbers);
                carried = start_path(camera_ray);
            }
        }
    } while (current < end);
}
