// As in the chapter: flips each digit by a hash of the key and the digits before it, which are the lower bits here.
uint scramble_reversed(uint bits, uint key) {
    bits ^= bits * 0x3d20adeau;
    bits += key;
    bits *= (key >> 16u) | 1u;
    bits ^= bits * 0x05526c56u;
    bits ^= bits * 0x53a22864u;
    return bits;
}

// Sobol's second dimension from its direction numbers, with the bits reversed: digit i of the index contributes row i of Pascal's
// triangle modulo 2. Each row is the one before, added to itself shifted by one.
uint get_second_dimension(uint index) {
    uint sum = 0u, row = 1u;
    while (index != 0u) {
        sum ^= row * (index & 1u);
        row ^= row << 1u;
        index >>= 1u;
    }
    return sum;
}

// The two halves have hashes that belong to different places of the key.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint half_index = sample_index % 2u, place = sample_index / 2u;
    uvec2 state = get_state(pixel_index, half_index, key);
    return uvec2(place, state.y);
}

// The next point. Of the four words of two steps of the generator one is for the order and two are for the scrambles, and the first
// number comes from the second dimension.
uvec2 get_random_words(inout uvec2 seed) {
    uvec2 first = uvec2(0x5bd1e995u, seed.y);
    advance_random_state(first);
    uvec2 second = first;
    advance_random_state(second);
    seed.y += 0x6c8e9cf5u;
    uint order = bitfieldReverse(scramble_reversed(bitfieldReverse(seed.x), first.y));
    uint x = scramble_reversed(get_second_dimension(order), second.y);
    uint y = scramble_reversed(order, second.x);
    return uvec2(bitfieldReverse(x), bitfieldReverse(y));
}
