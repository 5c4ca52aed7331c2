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

// Start state of one sample of one pixel. For a given key all steps are bijections, so no two samples start alike;
// the slides' pixel_index + 2^16 * frame_index lets most samples of an image share their numbers with others.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uvec2 seed = uvec2(pixel_index, sample_index);
    advance_random_state(seed);
    seed ^= key;
    advance_random_state(seed);
    return seed;
}

// Two independent numbers, uniform in [0,1). Only 24 bits are used: all 32 would round up to 1.0 now and then.
vec2 get_random_numbers(inout uvec2 seed) {
    advance_random_state(seed);
    return vec2(seed >> 8u) * (1.0 / 16777216.0);
}

// An index below `count`, from 32 bits: 24-bit numbers would give a million entries unequal chances. The other word of the
// state is independent of it.
uint get_random_index(uint count, inout uvec2 seed) {
    advance_random_state(seed);
    uint index, unused;
    umulExtended(seed.x, count, index, unused);
    return index;
}

// Whether something of this probability happens: whether a random number of 64 bits is below it, exactly from 2^-40 on.
// With 24 bits what has the probability 1e-9 would happen sixty times too often. If the probability is not a number it
// happens, so that the sample is counted as invalid.
bool happens(float probability, inout uvec2 seed) {
    advance_random_state(seed);
    if (!(probability < 1.0)) return true;
    float scaled = 4294967296.0 * probability;
    uint first = uint(scaled), second = uint(4294967296.0 * fract(scaled));
    return seed.x < first || (seed.x == first && seed.y < second);
}
