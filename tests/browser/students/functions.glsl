// Names of functions that GLSL 4.60 has and the language of browsers has not, and names that the page uses.
vec3 materials_at(uint i) { return vec3(float(i)); }
float media(float x) { return 2.0 * x; }
uint target_samples = 3u, is_preview = 2u;

vec3 path_trace(Ray ray, inout uvec2 seed) {
    float findMSB = 0.5, mix = 1.0;
    return vec3(fma(1.0, 2.0, 0.5), float(bitCount(7u)), findMSB * mix) + materials_at(target_samples) + media(float(is_preview)) + float(bitfieldReverse(1u) >> 30u);
}
