// Light that light paths send to pixels other than their own.

layout(scalar, set = 0, binding = BINDING_SPLATS) buffer Splats { uint splats[]; };

// Adds radiance to a pixel, for the light path of the sample with this index: the film divides the sum by the number of samples.
void add_splat(uvec2 pixel, vec3 radiance, uint sample_index) {
    vec3 units = floor(radiance / parameters.splat_unit + 0.5);
    vec3 high_digits = floor(units / 4294967296.0);
    uint word = SPLAT_WORDS * (pixel.y * parameters.image_size.x + pixel.x);
    // Not negative, nor NaN, nor so large that sums might overflow.
    if (!all(greaterThanEqual(units, vec3(0.0))) || !all(lessThan(high_digits, vec3(67108864.0)))) {
        atomicAdd(splats[word + SPLAT_WORDS - 1u], 1u);
        return;
    }
    uvec3 low = uvec3(units - 4294967296.0 * high_digits), high = uvec3(high_digits);
    word += 6u * (sample_index & 1u);
    for (uint c = 0u; c < 3u; ++c, word += 2u) {
        uint before = atomicAdd(splats[word], low[c]);
        uint carry = before + low[c] < before ? 1u : 0u;
        if (high[c] + carry != 0u) atomicAdd(splats[word + 1u], high[c] + carry);
    }
}
