// Owen scrambling of a number whose bits are reversed: each bit is flipped or not, by a hash of the key and all digits
// before it, which here are the lower bits. Sums and products carry upwards only. Constants: Vegdahl, "Building a Better
// LK Hash", 2021; the idea: Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4) 2020.
uint scramble_reversed(uint bits, uint key) {
    bits ^= bits * 0x3d20adeau;
    bits += key;
    bits *= (key >> 16u) | 1u;
    bits ^= bits * 0x05526c56u;
    bits ^= bits * 0x53a22864u;
    return bits;
}

// The sample's index and a hash, of the pixel and of the scramble. Samples 2^k to 2^(k+1) - 1 share a scramble and fill
// the unit square evenly. Those before have others. So whenever the samples of a pixel double, the new ones are
// independent of the old ones, and the difference of the halves tells the error.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint scramble = uint(findMSB(sample_index) + 1);
    return uvec2(sample_index, get_state(pixel_index, scramble, key).x);
}

// One coordinate of point number `index`: van der Corput's sequence, scrambled.
uint get_coordinate(uint index, uint key) { return bitfieldReverse(scramble_reversed(index, key)); }

// The words of the pixel's next point.
uvec2 get_random_words(inout uvec2 seed) {
    // hashes for this pair
    uvec2 order_keys = uvec2(seed.y, 0u);
    advance_random_state(order_keys);
    uvec2 point_keys = order_keys;
    advance_random_state(point_keys);
    seed.y += 0x9e3779b9u;

    // the place in the order of this pair
    uint index = bitfieldReverse(scramble_reversed(bitfieldReverse(seed.x), order_keys.x));

    // x and y have keys of their own, so they are independent
    uint x = get_coordinate(index, point_keys.x);
    uint y = get_coordinate(index, point_keys.y);
    return uvec2(x, y);
}
