#version 460
// Adds to a film in a browser what the light paths of its latest sample have sent to each pixel.
#include "interface.h"
#include "film.glsl"
#include "film_words.glsl"

uniform highp sampler2D web_splats;
layout(location = 3) out uvec4 web_splat_words;  // see splats_of_a_draw.glsl

void main() {
    uint last;
    FilmPixel pixel = web_read_film(last);
    --pixel.sample_count;  // since this light belongs to the latest sample, and to its half
    add_sample(pixel, texelFetch(web_splats, ivec2(gl_FragCoord.xy), 0).rgb);
    web_write_film(pixel, last);
    web_splat_words = uvec4(0u);
}
