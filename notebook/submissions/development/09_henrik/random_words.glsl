// Henrik, chapter 9: Sobol points with Cranley-Patterson rotation. Every pair of a pixel shifts the points by a random vector.

// Scrambling for the order of the points only.
uint scramble_reversed(uint bits, uint key) {
    bits ^= bits * 0x3d20adeau;
    bits += key;
    bits *= (key >> 16u) | 1u;
    bits ^= bits * 0x05526c56u;
    bits ^= bits * 0x53a22864u;
    return bits;
}

// The second dimension of Sobol's sequence, with its bits reversed: the index times Pascal's triangle modulo 2. The
// triangle of 2^k rows consists of copies of that of half the size, and so five steps suffice. The first dimension, van
// der Corput's sequence, is the index itself.
uint get_second_dimension(uint index) {
    index ^= (index & 0xaaaaaaaau) >> 1u;
    index ^= (index & 0xccccccccu) >> 2u;
    index ^= (index & 0xf0f0f0f0u) >> 4u;
    index ^= (index & 0xff00ff00u) >> 8u;
    index ^= (index & 0xffff0000u) >> 16u;
    return index;
}

// The sample's index and a hash, of the pixel and of the scramble. Samples 2^k to 2^(k+1) - 1 share a scramble and fill
// the unit square evenly. Those before have others. So whenever the samples of a pixel double, the new ones are
// independent of the old ones, and the difference of the halves tells the error.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint scramble = uint(findMSB(sample_index) + 1);
    return uvec2(sample_index, get_state(pixel_index, scramble, key).x);
}

uvec2 get_random_words(inout uvec2 seed) {
    // two hashes: one for the order, one for the shift
    uvec2 order = uvec2(seed.y, 0u);
    advance_random_state(order);
    uvec2 shift = order;
    advance_random_state(shift);

    uint index = bitfieldReverse(scramble_reversed(bitfieldReverse(seed.x), order.x));
    uvec2 point = bitfieldReverse(uvec2(index, get_second_dimension(index)));
    seed.y += 0x9e3779b9u;
    // half of each, so that the sum does not overflow
    return (point >> 1u) + (shift >> 1u);
}
