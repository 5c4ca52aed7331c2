// Owen scrambling by its definition: a coin flip for each node of the tree of digits. The digits after the 16th move a point by
// less than 2^-16, so a single hash decides about them.

uint coin(uint level, uint path, uint key) {
    uvec2 state = uvec2(path ^ key, key + 0x632be59bu * (level + 1u));
    advance_random_state(state);
    return state.x >> 31u;
}

// Flips the first 16 digits of a number, the highest first.
uint flip_digits(uint number, uint key) {
    uint result = 0u;
    for (uint level = 0u; level < 16u; ++level) {
        uint path = level == 0u ? 0u : number >> (32u - level);
        uint digit = number >> (31u - level) & 1u;
        result = result << 1u | (digit ^ coin(level, path, key));
    }
    uvec2 rest = uvec2(number, key);
    advance_random_state(rest);
    return result << 16u | rest.y >> 16u;
}

// Points 0, 1, ... of the sequence: the index backwards, and its product with Pascal's triangle.
uvec2 get_sobol_point(uint index) {
    uint second = 0u;
    for (uint row = 1u << 31u, digits = index; digits != 0u; digits >>= 1u, row ^= row >> 1u)
        second ^= (digits & 1u) * row;
    return uvec2(bitfieldReverse(index), second);
}

uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    return uvec2(sample_index / 2u, get_state(pixel_index, 2u + sample_index % 2u, key.yx).y);
}

// An order by a bijection that keeps every aligned block of 2^k indices together: digits are flipped by the higher ones, of
// which only the lowest 16 differ.
uvec2 get_random_words(inout uvec2 seed) {
    uvec2 keys = uvec2(0x5bd1e995u, seed.y), others = keys;
    advance_random_state(keys);
    others = keys;
    advance_random_state(others);
    seed.y = others.y;
    uint place = flip_digits(seed.x << 16u, keys.x) >> 16u;
    uvec2 point = get_sobol_point(place);
    return uvec2(flip_digits(point.x, keys.y), flip_digits(point.y, others.x));
}
