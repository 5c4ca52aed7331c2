#version 460
// The path tracer in a browser: a fragment renders samples of a pixel. tools/book/live/glsl.js translates it, and all that it
// includes, to GLSL ES 3.00.
#include "interface.h"
#include "world/scene.glsl"

DispatchParameters dispatch;

#include "world/ray.glsl"
#include "engine/trace_ray/compute.glsl"

// Counts the iterations of an estimator's loops: a browser cannot interrupt a shader, and a system takes the GPU away from one
// that goes on for seconds. The translation asks before each turn of a loop, `place` numbers the line.
uint loop_iterations = 0u;
uint stuck_place = 0u;
bool is_loop_stuck(uint place) {
    uint paths = min(parameters.max_path_length * parameters.splitting_factor, 4096u);
    if (++loop_iterations <= 4096u + dispatch.samples_per_pixel * (1024u + 16u * paths)) return false;
    if (stuck_place == 0u) stuck_place = place;
    return true;
}

#include "render_samples.glsl"

// A pixel of the film with its number of rays takes twelve words. Above STUCK, the last one is the place of a loop that does not
// end.
const uint STUCK = 0x80000000u;
uniform usampler2D film_before[3];
uniform uint target_samples;
uniform uint samples_per_pixel;  // the most that a pixel still lacks
uniform bool is_preview;         // renders only the first 2 x 2 pixels of each block, which stand for the others
layout(location = 0) out uvec4 film_words_0;
layout(location = 1) out uvec4 film_words_1;
layout(location = 2) out uvec4 film_words_2;

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    uvec4 a = texelFetch(film_before[0], place, 0);
    uvec4 b = texelFetch(film_before[1], place, 0);
    uvec4 c = texelFetch(film_before[2], place, 0);
    film[0] = FilmPixel(uintBitsToFloat(a.xyz), uintBitsToFloat(uvec3(a.w, b.xy)),
                        uintBitsToFloat(uvec3(b.zw, c.x)), c.y, c.z);
    ray_counters[0] = c.w;

    uvec2 position = uvec2(place);
    uint blocks_per_row = (parameters.image_size.x + BLOCK_WIDTH - 1u) / BLOCK_WIDTH;
    uvec2 block = position / uvec2(BLOCK_WIDTH, BLOCK_HEIGHT), corner = block * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT);
    uint pixel_index = position.y * parameters.image_size.x + position.x;
    dispatch = DispatchParameters(block.y * blocks_per_row + block.x, 1u, samples_per_pixel, target_samples, pixel_index);
    bool is_left_out = is_preview && any(greaterThan(position - corner, uvec2(1u)));
    if (!is_left_out) render_pixel((position.y - corner.y) * BLOCK_WIDTH + position.x - corner.x);

    uvec3 sum = floatBitsToUint(film[0].sum), compensation = floatBitsToUint(film[0].compensation);
    uvec3 difference = floatBitsToUint(film[0].difference);
    film_words_0 = uvec4(sum, compensation.x);
    film_words_1 = uvec4(compensation.yz, difference.xy);
    uint last = c.w >= STUCK ? c.w : stuck_place != 0u ? STUCK | stuck_place : ray_counters[0];
    film_words_2 = uvec4(difference.z, film[0].sample_count, film[0].invalid_count, last);
}
