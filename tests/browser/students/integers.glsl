// bits and integers of GLSL 4.60
vec3 path_trace(Ray ray, inout uvec2 seed) {
    uint high, low, carry;
    umulExtended(0xdeadbeefu, 12345u, high, low);
    uint s = uaddCarry(low, 0xffffffffu, carry);
    uint b = bitfieldReverse(s) >> 8u;
    return vec3(float(high), float(carry + uint(findMSB(s)) + uint(bitCount(b))), float(b) / 16777216.0 + fma(0.5, 2.0, 1.0) + float(findLSB(8u)));
}
