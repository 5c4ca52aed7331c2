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

// The same from a point with two words of its digits, which go on in a hash of both: 64 digits, since in a table of 2^23
// entries 32 would leave each of them 9. `digits` are those that the index has not used up, 32 random bits. (The table's
// probabilities count words. Entries differ from that by a part of 2^-32 count at most, and for 2^k entries not at all.)
uint get_random_index(uint count, uvec2 words, out uint digits) {
    uint index, first, more, unused, carry;
    umulExtended(words.x, count, index, first);
    advance_random_state(words);
    umulExtended(words.x, count, more, unused);
    digits = uaddCarry(first, more, carry);
    return index + carry;
}

// Whether an entry of an alias table gives way to its alias, by these digits. They lie on one side of the threshold and
// make another number, uniform in [0,1). Of points that are evenly spread it leaves points that are evenly spread on each
// entry, while a second word would draw lots.
bool gives_way(uint digits, uint threshold, out float rest) {
    bool is_above = digits >= threshold;
    float width = is_above ? float(~threshold) + 1.0 : float(threshold);
    rest = min(float(is_above ? digits - threshold : digits) / width, 1.0 - 1.0 / 16777216.0);
    return is_above;
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
