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

// A pixel of the film with its number of rays takes twelve words. Above web_stuck, the last one is the place of a loop that does not
// end.
const uint web_stuck = 0x80000000u;
uniform usampler2D web_film_before[3];
uniform uint web_target_samples;
uniform uint web_samples_per_pixel;  // the most that a pixel still lacks
uniform bool web_is_preview;         // renders only the first 2 x 2 pixels of each block, which stand for the others
layout(location = 0) out uvec4 web_film_words_0;
layout(location = 1) out uvec4 web_film_words_1;
layout(location = 2) out uvec4 web_film_words_2;

void main() {
    ivec2 place = ivec2(gl_FragCoord.xy);
    uvec4 a = texelFetch(web_film_before[0], place, 0);
    uvec4 b = texelFetch(web_film_before[1], place, 0);
    uvec4 c = texelFetch(web_film_before[2], place, 0);
    film[0] = FilmPixel(uintBitsToFloat(a.xyz), uintBitsToFloat(uvec3(a.w, b.xy)),
                        uintBitsToFloat(uvec3(b.zw, c.x)), c.y, c.z);
    ray_counters[0] = c.w;

    uvec2 position = uvec2(place);
    uint blocks_per_row = (parameters.image_size.x + BLOCK_WIDTH - 1u) / BLOCK_WIDTH;
    uvec2 block = position / uvec2(BLOCK_WIDTH, BLOCK_HEIGHT), corner = block * uvec2(BLOCK_WIDTH, BLOCK_HEIGHT);
    uint pixel_index = position.y * parameters.image_size.x + position.x;
    dispatch = DispatchParameters(block.y * blocks_per_row + block.x, 1u, web_samples_per_pixel, web_target_samples, pixel_index);
    bool is_left_out = web_is_preview && any(greaterThan(position - corner, uvec2(1u)));
    if (!is_left_out) render_pixel((position.y - corner.y) * BLOCK_WIDTH + position.x - corner.x);

    uvec3 sum = floatBitsToUint(film[0].sum), compensation = floatBitsToUint(film[0].compensation);
    uvec3 difference = floatBitsToUint(film[0].difference);
    web_film_words_0 = uvec4(sum, compensation.x);
    web_film_words_1 = uvec4(compensation.yz, difference.xy);
    uint last = c.w >= web_stuck ? c.w : web_stuck_place != 0u ? web_stuck | web_stuck_place : ray_counters[0];
    web_film_words_2 = uvec4(difference.z, film[0].sample_count, film[0].invalid_count, last);
}
