// Pseudorandom numbers by PCG2D (Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3) 2020), as on the
// slides.

// One step of the generator, a bijection on the 2^64 states.
void advance_random_state(inout uvec2 seed) {
    seed = 1664525u * seed + 1013904223u;
    seed.x += 1664525u * seed.y;
    seed.y += 1664525u * seed.x;
    seed ^= (seed >> 16u);
    seed.x += 1664525u * seed.y;
    seed.y += 1664525u * seed.x;
    seed ^= (seed >> 16u);
}

// A distinct state for each pixel and index: for a given key, all steps are bijections. (With the slides' pixel_index + 2^16 *
// frame_index most samples of an image repeat the numbers of another sample.)
uvec2 get_state(uint pixel_index, uint index, uvec2 key) {
    uvec2 state = uvec2(pixel_index, index);
    advance_random_state(state);
    state ^= key;
    advance_random_state(state);
    return state;
}

// random_start_state() and get_random_words(): independent numbers, unless the chapter's folder brings a file of this name.
#include "random_words.glsl"

// Random words as numbers in [0,1). Uses 24 bits only, since 32 bits would sometimes round up to 1.0.
vec2 to_numbers(uvec2 words) { return vec2(words >> 8u) * (1.0 / 16777216.0); }

// Two independent numbers, uniform in [0,1).
vec2 get_random_numbers(inout uvec2 seed) { return to_numbers(get_random_words(seed)); }

// A uniform index below `count` from 64 bits: those of words.x, extended by a hash of both words. With 32 bits, the entries of a
// large table would get unequal shares: of 10^7 entries some would get 430 words and others 429. `digits` returns the 32 bits
// that are left over after the choice of the index.
uint get_random_index(uint count, uvec2 words, out uint digits) {
    uint index, first, more, unused, carry;
    umulExtended(words.x, count, index, first);
    advance_random_state(words);
    umulExtended(words.x, count, more, unused);
    digits = uaddCarry(first, more, carry);
    return index + carry;
}

// Whether an entry of an alias table gives way to its alias: whether `digits` are at or above the threshold. `rest` is their
// position on that side of it, uniform in [0,1). If the digits are stratified, so is `rest` for each entry; deciding by a second
// random word would lose that.
bool gives_way(uint digits, uint threshold, out float rest) {
    bool is_above = digits >= threshold;
    float width = is_above ? float(~threshold) + 1.0 : float(threshold);
    rest = min(float(is_above ? digits - threshold : digits) / width, 1.0 - 1.0 / 16777216.0);
    return is_above;
}

// Returns true with the given probability, which is in [0,1]. It is exact from 2^-40 upwards, by comparing it with 64 random
// bits: 24 bits would make an event of probability 1e-9 sixty times too frequent. A NaN counts as 1, so that it reaches the film, which
// counts invalid samples.
bool happens(float probability, inout uvec2 seed) {
    uvec2 words = get_random_words(seed);
    if (!(probability < 1.0)) return true;
    float scaled = 4294967296.0 * probability;
    uint first = uint(scaled), second = uint(4294967296.0 * fract(scaled));
    return words.x < first || (words.x == first && words.y < second);
}
