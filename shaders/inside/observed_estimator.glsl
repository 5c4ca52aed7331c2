// The estimator that somebody observes, under other names: path_trace() is the observer's own.
#define path_trace observed_path_trace
#define Path ObservedPath
#define start_path observed_start_path
#define extend_path observed_extend_path
#include "observed.glsl"
#undef path_trace
#undef Path
#undef start_path
#undef extend_path
#ifdef PATH_REGENERATION
#define OBSERVED_PATH_REGENERATION
#undef PATH_REGENERATION
#endif
