// Owen-scrambled Sobol points, chapter 9, by Fatima. All numbers are kept the usual way round, highest digit first.

// Flips each bit depending on the bits above it and on the key (Laine and Karras' idea, Vegdahl's constants).
uint owen_scramble(uint x, uint key) {
    x = bitfieldReverse(x);
    x ^= x * 0x3d20adeau;
    x += key;
    x *= (key >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return bitfieldReverse(x);
}

// Sobol, dimensions 0 and 1: the radical inverse, and the radical inverse times Pascal's triangle modulo 2.
uvec2 sobol(uint index) {
    uint x = bitfieldReverse(index);
    uint y = x;
    y ^= y << 16u;
    y ^= (y & 0x00ff00ffu) << 8u;
    y ^= (y & 0x0f0f0f0fu) << 4u;
    y ^= (y & 0x33333333u) << 2u;
    y ^= (y & 0x55555555u) << 1u;
    return uvec2(x, y);
}

// x: index of the sample, y: hash of pixel and block of samples.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    // Samples 1, 2-3, 4-7, 8-15, ... are blocks with scrambles of their own.
    uint block = uint(findMSB(sample_index) + 1);
    return uvec2(sample_index, get_state(pixel_index, block, key).x);
}

uvec2 get_random_words(inout uvec2 seed) {
    uvec2 hash = uvec2(seed.y, 0x1234567u);
    advance_random_state(hash);
    // Another order of the points for each pair: it keeps blocks of 2^k together.
    uint shuffled = owen_scramble(seed.x, hash.x ^ hash.y);
    advance_random_state(hash);
    uvec2 p = sobol(shuffled);
    seed.y += 0x9e3779b9u;
    return uvec2(owen_scramble(p.x, hash.x), owen_scramble(p.y, hash.y));
}
