// Renders the samples first, first + step, ... below `end` of a pixel, one after the other. A chapter's folder may bring its own
// loop in a file of this name.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    for (uint i = first; i < end; i += step) {
        uvec2 seed;
        Ray ray = start_sample(position, i, seed);
        finish_sample(path_trace(ray, seed));
    }
}
