// The default source of random words: a stream of independent words for each sample.

// The state that a pixel's sample starts from.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    return get_state(pixel_index, sample_index, key);
}

// Two independent words of 32 random bits.
uvec2 get_random_words(inout uvec2 seed) {
    advance_random_state(seed);
    return seed;
}
