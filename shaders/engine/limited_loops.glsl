// Ends loops that would never end. common/tracing/limited_loops.cpp inserts calls of is_loop_stuck() into the loops of an estimator.

uint loop_iterations;         // of the current sample
uint samples_with_own_loops; // how many samples may still start to count anew

// More than any sample of a right estimator needs.
uint get_iteration_limit() {
    float paths = float(parameters.max_path_length) * float(parameters.splitting_factor);
    float iterations = 16.0;  // of a bounce, not counting those that a grid takes
#ifdef FEATURE_DENSITIES
    iterations += 12000.0;  // twice what common/scene/media.cpp allows for two rays through it
#endif
    return 65536u + uint(min(iterations * paths, 1e9));
}

void start_counting_iterations() {
    // A loop over samples that never ends starts more of them than there are.
    if (samples_with_own_loops == 0u) return;
    --samples_with_own_loops;
    loop_iterations = 0u;
}

// bool is_loop_stuck(uint place)
#include "stuck_loop.glsl"
