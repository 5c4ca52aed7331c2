#version 460
// Points from an estimator's own random numbers: consecutive pairs of random words of a sample.
#include "observation/estimator_stub.glsl"
#include "world/lights.glsl"
bool is_occluded(Ray ray, float t_max) { return false; }
#include "path_trace.glsl"

struct Input {
    uint pixel, sample_index;
    uvec2 key;
};
struct Result {
    uvec2 words[PAIRS];
};

layout(scalar, binding = 0) writeonly buffer Results { Result results[]; };
layout(scalar, binding = 1) readonly buffer Inputs { Input inputs[]; };

layout(local_size_x = 128) in;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= inputs.length()) return;
    uvec2 seed = random_start_state(inputs[i].pixel, inputs[i].sample_index, inputs[i].key);
    for (int pair = 0; pair < PAIRS; ++pair) results[i].words[pair] = get_random_words(seed);
}
