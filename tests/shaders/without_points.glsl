// Chapter 9 with random numbers instead of its points.
#include "light_probe_sampling.glsl"
#define random_start_state unused_random_start_state
#define get_random_words unused_get_random_words
#include "observed.glsl"
#undef random_start_state
#undef get_random_words
