// Renders one sample of a pixel, if one below `end` is left: the browser's loop is one over draws. Compilers for Direct3D take twice
// as long where a chapter's loops are inside of another.
void render_samples(uvec2 position, uint first, uint end, uint step) {
    if (first >= end) return;
    uvec2 seed;
    Ray ray = start_sample(position, first, seed);
    finish_sample(path_trace(ray, seed));
}
