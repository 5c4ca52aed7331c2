// The observed estimator under another name, since path_trace() is the observer's own.
#define path_trace observed_path_trace
#include "observed.glsl"
#undef path_trace
