#version 460
// One function of random.glsl, chosen by a define, for each input.
#extension GL_EXT_scalar_block_layout : require
#include "world/random.glsl"

#ifdef START_STATES
struct Input { uint pixel_index; uint sample_index; uvec2 key; };
#define Result uvec2
uvec2 evaluate(Input i) { return random_start_state(i.pixel_index, i.sample_index, i.key); }
#elif defined(NEXT_STATES)
#define Input uvec2
#define Result uvec2
uvec2 evaluate(Input state) {
    advance_random_state(state);
    return state;
}
#elif defined(NUMBERS)
// The numbers that a path's sample uses.
struct Input { uint pixel_index; uint sample_index; uvec2 key; };
struct Result { vec2 numbers[NUMBERS]; };
Result evaluate(Input i) {
    uvec2 seed = random_start_state(i.pixel_index, i.sample_index, i.key);
    Result result;
    for (int dimension = 0; dimension < NUMBERS; ++dimension) result.numbers[dimension] = get_random_numbers(seed);
    return result;
}
#elif defined(HAPPENS)
struct Input { uvec2 state; float probability; };
#define Result uint
uint evaluate(Input i) { return happens(i.probability, i.state) ? 1u : 0u; }
#else
// Over an image of `pixels` pixels with one sample each: the sum and sum of squares of a function of four random numbers.
struct Input { uint pixels; uint sample_index; uvec2 key; };
#define Result vec2
vec2 evaluate(Input i) {
    vec2 sums = vec2(0.0);
    for (uint pixel_index = 0u; pixel_index < i.pixels; ++pixel_index) {
        uvec2 seed = random_start_state(pixel_index, i.sample_index, i.key);
        vec2 first = get_random_numbers(seed);
        vec2 second = get_random_numbers(seed);
        float value = first.x + first.y * first.y + 3.0 * second.x * second.y;
        sums += vec2(value, value * value);
    }
    return sums;
}
#endif

layout(scalar, binding = 0) writeonly buffer Results { Result results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { Input inputs[]; };

layout(local_size_x = 128) in;

void main() {
    if (gl_GlobalInvocationID.x < inputs.length())
        results[gl_GlobalInvocationID.x] = evaluate(inputs[gl_GlobalInvocationID.x]);
}
