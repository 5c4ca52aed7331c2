// Owen-scrambled Sobol points after Burley (2020), with the constants of his paper.

// The hash of Laine and Karras: a bit depends on the key and on lower bits only.
uint laine_karras(uint x, uint key) {
    x += key;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

uint owen_scramble(uint x, uint key) { return bitfieldReverse(laine_karras(bitfieldReverse(x), key)); }

// Sobol's first two dimensions by their direction numbers. The first: 1/2, 1/4, 1/8 and so on. The second: v_1 = 1/2, and
// then v_{i+1} = v_i xor v_i / 2.
uvec2 sobol(uint index) {
    uvec2 point = uvec2(0u);
    uvec2 v = uvec2(0x80000000u);
    for (; index != 0u; index >>= 1u) {
        if ((index & 1u) != 0u) point ^= v;
        v = uvec2(v.x >> 1u, v.y ^ (v.y >> 1u));
    }
    return point;
}

// The sample's index and a hash, of the pixel and of the scramble. Samples 2^k to 2^(k+1) - 1 share a scramble and fill
// the unit square evenly. Those before have others. So whenever the samples of a pixel double, the new ones are
// independent of the old ones, and the difference of the halves tells the error.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint scramble = uint(findMSB(sample_index) + 1);
    return uvec2(sample_index, get_state(pixel_index, scramble, key).x);
}

// The words of the pixel's next point: four fresh hashes shuffle the index and scramble each dimension.
uvec2 get_random_words(inout uvec2 seed) {
    uvec2 first = uvec2(seed.y, 1u), second = uvec2(seed.y, 2u);
    advance_random_state(first);
    advance_random_state(second);
    seed.y += 0x9e3779b9u;

    uint shuffled = owen_scramble(seed.x, first.x);
    uvec2 point = sobol(shuffled);
    return uvec2(owen_scramble(point.x, second.x), owen_scramble(point.y, second.y));
}
