#version 460
// Filters a picture in a browser, see filter_steps.glsl: a draw is a step. A FilterPixel takes as many words as a pixel of a film, and
// is stored like one.
#include "interface.h"
#include "film.glsl"
#include "film_words.glsl"

uniform FilterParameters filtering;

ivec2 web_get_place(uint pixel_index) { return ivec2(pixel_index % filtering.image_size.x, pixel_index / filtering.image_size.x); }

// The page's arrays are here films, the words of each as film_words.glsl divides them into three textures.
FilmPixel get_film_pixel(uint film, uint pixel_index) {
    int count = int(filtering.image_size.x * filtering.image_size.y), at = 3 * int(film) * count + int(pixel_index);
    return web_film_pixel(web_texel(at), web_texel(at + count), web_texel(at + 2 * count));
}

vec3 get_mean_at(uint pixel_index, int half_index) {
    ivec2 place = web_get_place(pixel_index);
    uvec4 a = texelFetch(web_film_before[0], place, 0);
    return uintBitsToFloat(half_index == 0 ? a.xyz : uvec3(a.w, texelFetch(web_film_before[1], place, 0).xy));
}

vec3 get_variance_at(uint pixel_index, int half_index) {
    ivec2 place = web_get_place(pixel_index);
    uvec4 c = texelFetch(web_film_before[2], place, 0);
    return uintBitsToFloat(half_index == 0 ? uvec3(texelFetch(web_film_before[1], place, 0).zw, c.x) : c.yzw);
}

// The place of a loop that does not end, as in render.frag, stands in the last word, with its first bit.
const uint web_stuck = 0x80000000u;
uniform uint web_most_turns;  // of the loops of a pixel
uint web_turns = 0u, web_stuck_place = 0u;
bool is_loop_stuck(uint place) {
    if (web_stuck_place == 0u && ++web_turns <= web_most_turns) return false;
    if (web_stuck_place == 0u) web_stuck_place = place;
    return true;
}

#include "filter_steps.glsl"

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    if (filtering.step == FILTER_STEP_PICTURE)
        web_write_film(make_picture(p), 0u);
    else {
        FilterPixel result = run_step(p);
        uvec3 mean = floatBitsToUint(result.mean[1]), variance = floatBitsToUint(result.variance[0]);
        web_film_words_0 = uvec4(floatBitsToUint(result.mean[0]), mean.x);
        web_film_words_1 = uvec4(mean.yz, variance.xy);
        web_film_words_2 = uvec4(variance.z, floatBitsToUint(result.variance[1]));
    }
    if (web_stuck_place != 0u) web_film_words_2.w = web_stuck | web_stuck_place;
}
