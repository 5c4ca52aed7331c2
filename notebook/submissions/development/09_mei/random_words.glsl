// Mei's points: Sobol's sequence. Each pair of a path takes the points of the pixel in an order of its own, by an exclusive or
// with the index: that only swaps points of a block of 2^k.

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

// x: the sample's index. y: a hash of pixel and block, from which the orders come.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint block = uint(findMSB(sample_index) + 1);
    return uvec2(sample_index, get_state(pixel_index, block, key).x);
}

uvec2 get_random_words(inout uvec2 seed) {
    uvec2 hash = uvec2(seed.y, 0u);
    advance_random_state(hash);
    seed.y += 0x9e3779b9u;

    // swap points of the blocks of 16
    uint index = seed.x ^ (hash.x >> 28u);
    uvec2 point = uvec2(index, get_second_dimension(index));
    return bitfieldReverse(point);
}
