// Chapter 2's estimator, but for the sample that starts with the random state POISONED_STATE, one channel is replaced by the
// number with the bits POISON.
#define path_trace path_trace_of_chapter
#include "../../chapters/02_cosine_sampling/path_trace.glsl"
#undef path_trace

vec3 path_trace(Ray ray, inout uvec2 seed) {
    bool is_poisoned = seed == uvec2(POISONED_STATE);
    vec3 radiance = path_trace_of_chapter(ray, seed);
    if (is_poisoned) radiance[POISONED_CHANNEL] = uintBitsToFloat(POISON);
    return radiance;
}
