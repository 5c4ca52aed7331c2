#version 460
// add_sample() on streams of samples that the CPU can sum exactly; or is_invalid() of given bits.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "world/random.glsl"
#include "engine/film.glsl"

#ifdef INVALID_BITS
#define Result uint
#define Input uint
uint evaluate(Input bits) { return is_invalid(uintBitsToFloat(bits)) ? 1u : 0u; }
#else
// Kinds of streams, as in film_test.cpp.
const uint UNIFORM = 0u;
const uint CONSTANT = 1u;
const uint OUTLIERS = 2u;
const uint INVALID = 3u;

struct Input { uint kind; uint sample_count; };
struct Result { FilmPixel pixel; vec3 plain_sum; };

vec3 get_sample(uint kind, uint index, inout uvec2 seed) {
    if (kind == CONSTANT) return vec3(0.1);
    vec2 u = get_random_numbers(seed);
    vec3 radiance = vec3(u, 1.0 - u.x);
    if (kind == OUTLIERS && index % 1024u == 0u) radiance += 4096.0;
    if (kind == INVALID && index % 5u == 0u) {
        uint bits[] = {0x7fc00000u, 0x7f800000u, 0xff800000u, 0x7f800001u};
        radiance[index % 3u] = uintBitsToFloat(bits[index % 4u]);
    }
    return radiance;
}

Result evaluate(Input i) {
    FilmPixel pixel = FilmPixel(vec3(0.0), vec3(0.0), vec3(0.0), 0u, 0u);
    vec3 plain_sum = vec3(0.0);
    uvec2 seed = random_start_state(i.kind, 0u, uvec2(0u));
    for (uint index = 0u; index < i.sample_count; ++index) {
        vec3 radiance = get_sample(i.kind, index, seed);
        add_sample(pixel, radiance);
        plain_sum += radiance;
    }
    return Result(pixel, plain_sum);
}
#endif

layout(scalar, binding = 0) writeonly buffer Results { Result results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { Input inputs[]; };

layout(local_size_x = 128) in;

void main() {
    if (gl_GlobalInvocationID.x < inputs.length())
        results[gl_GlobalInvocationID.x] = evaluate(inputs[gl_GlobalInvocationID.x]);
}
