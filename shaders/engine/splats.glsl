// Light that light paths send to pixels other than their own.

layout(scalar, set = 0, binding = BINDING_SPLATS) buffer Splats { uint splats[]; };

uint splat_half;         // of the current sample: 0 for the first, third, … of a pixel
bool has_invalid_splat;  // it then counts as an invalid sample

void start_splats(uint sample_index) {
    splat_half = sample_index & 1u;
    has_invalid_splat = false;
}

// Adds radiance to a pixel: the film divides the sum by the number of samples, for each of which there is a light path.
void add_splat(uvec2 pixel, vec3 radiance) {
    vec3 units = floor(radiance / parameters.splat_unit + 0.5);
    vec3 high_digits = floor(units / 4294967296.0);
    // Not negative, nor NaN, nor so large that sums might overflow.
    if (!all(greaterThanEqual(units, vec3(0.0))) || !all(lessThan(high_digits, vec3(1048576.0)))) {
        has_invalid_splat = true;
        return;
    }
    uvec3 low = uvec3(units - 4294967296.0 * high_digits), high = uvec3(high_digits);
    uint word = SPLAT_WORDS * (pixel.y * parameters.image_size.x + pixel.x) + 6u * splat_half;
    for (uint c = 0u; c < 3u; ++c, word += 2u) {
        if (units[c] == 0.0) continue;
        uint before = atomicAdd(splats[word], low[c]);
        uint carry = before + low[c] < before ? 1u : 0u;
        if (high[c] + carry != 0u) atomicAdd(splats[word + 1u], high[c] + carry);
    }
}
