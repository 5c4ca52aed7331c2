// Owen scrambling by hashing, bits reversed (lower bits are more significant digits).
uint owen(uint x, uint key) {
    x ^= x * 0x3d20adeau;
    x += key;
    x *= (key >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}
uint scramble_reversed(uint bits, uint key) { return owen(bits, key); }

// Pascal's triangle mod 2.
uint get_second_dimension(uint index) {
    uint x = index;
    x ^= (x >> 1u) & 0x55555555u;
    x ^= (x >> 2u) & 0x33333333u;
    x ^= (x >> 4u) & 0x0f0f0f0fu;
    x ^= (x >> 8u) & 0x00ff00ffu;
    return x ^ (x >> 16u);
}

// Even and odd samples get two different scrambles.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    return uvec2(sample_index, get_state(pixel_index, sample_index & 1u, key).x);
}

uvec2 get_random_words(inout uvec2 seed) {
    uvec2 k = uvec2(seed.y, 0u);
    advance_random_state(k);
    uint i = bitfieldReverse(owen(bitfieldReverse(seed.x), k.x));
    advance_random_state(k);
    uvec2 p = uvec2(owen(i, k.x), owen(get_second_dimension(i), k.y));
    seed.y += 0x9e3779b9u;
    return bitfieldReverse(p);
}
