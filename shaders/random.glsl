// Pseudorandom numbers: PCG2D (Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3) 2020), as on the
// slides.

// One step of the generator: a bijection of the 2^64 states.
void advance_random_state(inout uvec2 seed) {
    seed = 1664525u * seed + 1013904223u;
    seed.x += 1664525u * seed.y;
    seed.y += 1664525u * seed.x;
    seed ^= (seed >> 16u);
    seed.x += 1664525u * seed.y;
    seed.y += 1664525u * seed.x;
    seed ^= (seed >> 16u);
}

// A state of its own for each pixel and index. For a given key all steps are bijections, so no two of them are equal;
// the slides' pixel_index + 2^16 * frame_index lets most samples of an image share their numbers with others.
uvec2 get_state(uint pixel_index, uint index, uvec2 key) {
    uvec2 state = uvec2(pixel_index, index);
    advance_random_state(state);
    state ^= key;
    advance_random_state(state);
    return state;
}

// The state that a sample of a pixel starts from, and two words of 32 random bits, independent of each other.
#ifdef LOW_DISCREPANCY
// The chapter's path_trace.glsl makes points of its own, see chapter 9.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key);
uvec2 get_random_words(inout uvec2 seed);
#else
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    return get_state(pixel_index, sample_index, key);
}
uvec2 get_random_words(inout uvec2 seed) {
    advance_random_state(seed);
    return seed;
}
#endif

// Random words as numbers in [0,1). Only 24 bits are used: all 32 would round up to 1.0 now and then.
vec2 to_numbers(uvec2 words) { return vec2(words >> 8u) * (1.0 / 16777216.0); }

// Two independent numbers, uniform in [0,1).
vec2 get_random_numbers(inout uvec2 seed) { return to_numbers(get_random_words(seed)); }

// An index below `count` from a random word: 24-bit numbers would give a million entries unequal chances.
uint get_random_index(uint count, uint word) {
    uint index, unused;
    umulExtended(word, count, index, unused);
    return index;
}

// Whether an entry of an alias table that get_random_index() has chosen with words.x gives way to its alias, with exactly
// the probability 1 - threshold/2^32: by which of the words that choose this entry it is. In large tables these are few,
// so a hash of both words carries on from there. What is left makes another number, uniform in [0,1). Of points that are
// evenly spread it leaves points that are evenly spread on each entry, while a second word would draw lots.
bool gives_way(uvec2 words, uint count, uint threshold, out float rest) {
    uint remainder = words.x * count, before = remainder / count;  // of the entry's words, those below this one
    uint total = before + 1u + ~remainder / count;                 // and all of them
    advance_random_state(words);
    uint digits = words.x, kept, kept_digits;
    umulExtended(total, threshold, kept, kept_digits);
    // Counted in words, is (before, digits) below (kept, kept_digits)? Digits are those after the binary point.
    bool is_kept = before < kept || (before == kept && digits < kept_digits);
    const float digit = 1.0 / 4294967296.0;
    float position = is_kept ? float(before) + digit * float(digits)
                             : float(before - kept) + digit * (float(digits) - float(kept_digits));
    float width = is_kept ? float(kept) + digit * float(kept_digits)
                          : float(total - kept - 1u) + digit * (float(~kept_digits) + 1.0);
    rest = clamp(position / width, 0.0, 1.0 - 1.0 / 16777216.0);
    return !is_kept;
}

// Whether something of this probability happens: whether a random number of 64 bits is below it, exactly from 2^-40 on.
// With 24 bits what has the probability 1e-9 would happen sixty times too often. If the probability is not a number it
// happens, so that the sample is counted as invalid.
bool happens(float probability, inout uvec2 seed) {
    uvec2 words = get_random_words(seed);
    if (!(probability < 1.0)) return true;
    float scaled = 4294967296.0 * probability;
    uint first = uint(scaled), second = uint(4294967296.0 * fract(scaled));
    return words.x < first || (words.x == first && words.y < second);
}
