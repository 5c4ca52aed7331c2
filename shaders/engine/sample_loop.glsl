// Renders samples of a pixel one after the other: those with the indices first, first + step, ... below `end`. A chapter
// whose folder has a file of this name brings its own loop.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    for (uint i = first; i < end; i += step) {
        uvec2 seed;
        Ray ray = start_sample(position, i, seed);
        finish_sample(path_trace(ray, seed));
    }
}
