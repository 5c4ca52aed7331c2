// Owen scrambling of a number whose bits are reversed: whether a bit is flipped depends on a hash of the key and all digits
// before it, here the lower bits. Sums and products carry upwards only. Constants: Vegdahl, "Building a Better LK Hash", 2021;
// the idea: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4) 2020.
uint scramble_reversed(uint bits, uint key) {
    bits ^= bits * 0x3d20adeau;
    bits += key;
    bits *= (key >> 16u) | 1u;
    bits ^= bits * 0x05526c56u;
    bits ^= bits * 0x53a22864u;
    return bits;
}

// The second dimension of Sobol's sequence, with its bits reversed: the index times Pascal's triangle modulo 2. The triangle of
// 2^k rows consists of copies of the triangle of half the size, so five steps suffice. The first dimension, van der Corput's
// sequence, is the index itself.
uint get_second_dimension(uint index) {
    index ^= (index & 0xaaaaaaaau) >> 1u;
    index ^= (index & 0xccccccccu) >> 2u;
    index ^= (index & 0xf0f0f0f0u) >> 4u;
    index ^= (index & 0xff00ff00u) >> 8u;
    index ^= (index & 0xffff0000u) >> 16u;
    return index;
}

// The index of the sample's point, and a hash of pixel and sample.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    return uvec2(sample_index >> 1u, get_state(pixel_index, sample_index, key).x);
}

// The words of the pixel's next point. The hash in the state is incremented, so it repeats only after 2^32 pairs: hashing the
// hash again and again would soon run into a short cycle.
uvec2 get_random_words(inout uvec2 seed) {
    uvec2 keys = uvec2(seed.y, 0u);
    advance_random_state(keys);
    uint index = bitfieldReverse(scramble_reversed(bitfieldReverse(seed.x), keys.x));
    advance_random_state(keys);
    uvec2 point = uvec2(scramble_reversed(index, keys.x), scramble_reversed(get_second_dimension(index), keys.y));
    seed.y += 0x9e3779b9u;
    return bitfieldReverse(point);
}
