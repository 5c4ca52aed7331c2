// Sobol's second dimension by its direction numbers, and Owen scrambling as Burley publishes it: by the hash of Laine and
// Karras. The keys of a pair are hashes of its number.

uint laine_karras(uint x, uint key) {
    x += key;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

uint owen(uint x, uint key) { return bitfieldReverse(laine_karras(bitfieldReverse(x), key)); }

uint sobol(uint index) {
    uint result = 0u;
    for (uint v = 1u << 31u; index != 0u; index >>= 1u, v ^= v >> 1u)
        if ((index & 1u) != 0u) result ^= v;
    return result;
}

// Wellons' hash of 32 bits.
uint mix_bits(uint x) {
    x = 0x7feb352du * (x ^ (x >> 16u));
    x = 0x846ca68bu * (x ^ (x >> 15u));
    return x ^ (x >> 16u);
}

// Even and odd samples have different scrambles.
uvec2 random_start_state(uint pixel_index, uint sample_index, uvec2 key) {
    uint hash = mix_bits(key.y ^ mix_bits(pixel_index ^ mix_bits(key.x + sample_index % 2u)));
    return uvec2(sample_index / 2u, hash);
}

uvec2 get_random_words(inout uvec2 seed) {
    uint base = mix_bits(seed.y + 0x9e3779b9u);
    seed.y = base;
    uint shuffled = owen(seed.x, mix_bits(base ^ 1u));
    return uvec2(owen(bitfieldReverse(shuffled), mix_bits(base ^ 2u)), owen(sobol(shuffled), mix_bits(base ^ 3u)));
}
