// Accumulation of samples in a pixel.

// True for infinities and NaN. Looks at the bits, since compilers may assume that isnan() and isinf() are false.
bool is_invalid(float number) { return (floatBitsToUint(number) & 0x7f800000u) == 0x7f800000u; }

// Adds a sample by Kahan's compensated summation: in 32 bits a plain sum of 10^7 samples is off by percents.
// An invalid sample adds nothing but is counted.
void add_sample(inout FilmPixel pixel, vec3 radiance) {
    float sign_of_half = (pixel.sample_count & 1u) == 0u ? 1.0 : -1.0;
    pixel.sample_count += 1u;
    if (is_invalid(radiance.r) || is_invalid(radiance.g) || is_invalid(radiance.b)) {
        pixel.invalid_count += 1u;
        return;
    }
    // `precise` forbids the algebra that would cancel the compensation to zero.
    precise vec3 corrected = radiance + pixel.compensation;
    precise vec3 sum = pixel.sum + corrected;
    if (is_invalid(sum.r) || is_invalid(sum.g) || is_invalid(sum.b)) {  // the sum of finite samples can overflow
        pixel.invalid_count += 1u;
        return;
    }
    precise vec3 lost = corrected - (sum - pixel.sum);
    pixel.compensation = lost;
    pixel.sum = sum;
    pixel.difference += sign_of_half * radiance;
}
