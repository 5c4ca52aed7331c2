#version 460
// The path tracer in a browser: a fragment renders samples of a pixel. tools/book/live/glsl.js translates it, and all that it
// includes, to GLSL ES 3.00.
#include "interface.h"
#include "world/scene.glsl"

#define LIMITED_LOOPS
DispatchParameters dispatch;

#include "world/ray.glsl"
#include "engine/trace_ray/compute.glsl"

#include "render_samples.glsl"
#include "film_words.glsl"

// The film's last word is the number of rays, or from web_stuck on the place of a loop that does not end.
const uint web_stuck = 0x80000000u;
uniform uint web_target_samples;
uniform uint web_samples_per_pixel;  // the most that a pixel still lacks
uniform bool web_is_preview;         // renders only the first 2 x 2 pixels of each block, which stand for the others

void main() {
    uint before;
    film[0] = web_read_film(before);
    ray_counters[0] = before;

    uvec2 position = uvec2(gl_FragCoord.xy);
    uint blocks_per_row = (parameters.image_size.x + BLOCK_WIDTH - 1u) / BLOCK_WIDTH;
    uvec2 block = position / uvec2(BLOCK_WIDTH, BLOCK_HEIGHT), corner = block * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT);
    uint pixel_index = position.y * parameters.image_size.x + position.x;
    dispatch = DispatchParameters(block.y * blocks_per_row + block.x, 1u, web_samples_per_pixel, web_target_samples, pixel_index);
    bool is_left_out = web_is_preview && any(greaterThan(position - corner, uvec2(1u)));
    if (!is_left_out) render_pixel((position.y - corner.y) * BLOCK_WIDTH + position.x - corner.x);

    web_write_film(film[0], before >= web_stuck ? before : web_stuck_place != 0u ? web_stuck | web_stuck_place : ray_counters[0]);
#ifdef SPLATS
    web_write_splat();
#endif
}
