// A pixel of the film in a browser: with its number of rays it takes twelve words of three textures. A draw reads them from one film and
// writes them to another.

uniform usampler2D web_film_before[3];
layout(location = 0) out uvec4 web_film_words_0;
layout(location = 1) out uvec4 web_film_words_1;
layout(location = 2) out uvec4 web_film_words_2;

// The pixel with these words, without the last one, which is no part of it.
FilmPixel web_film_pixel(uvec4 a, uvec4 b, uvec4 c) {
    return FilmPixel(uintBitsToFloat(a.xyz), uintBitsToFloat(uvec3(a.w, b.xy)), uintBitsToFloat(uvec3(b.zw, c.x)), c.y, c.z);
}

// The pixel of this fragment, and its last word.
FilmPixel web_read_film(out uint last) {
    ivec2 place = ivec2(gl_FragCoord.xy);
    uvec4 a = texelFetch(web_film_before[0], place, 0);
    uvec4 b = texelFetch(web_film_before[1], place, 0);
    uvec4 c = texelFetch(web_film_before[2], place, 0);
    last = c.w;
    return web_film_pixel(a, b, c);
}

void web_write_film(FilmPixel pixel, uint last) {
    uvec3 sum = floatBitsToUint(pixel.sum), compensation = floatBitsToUint(pixel.compensation);
    uvec3 difference = floatBitsToUint(pixel.difference);
    web_film_words_0 = uvec4(sum, compensation.x);
    web_film_words_1 = uvec4(compensation.yz, difference.xy);
    web_film_words_2 = uvec4(difference.z, pixel.sample_count, pixel.invalid_count, last);
}
