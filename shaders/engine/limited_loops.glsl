// Ends loops that would never end. common/tracing/limited_loops.cpp inserts calls of is_loop_stuck() into the loops of an estimator.

uint loop_iterations;         // of the current sample
uint samples_with_own_loops; // how many samples may still start to count anew

// More than any sample of a right estimator needs.
uint get_iteration_limit() {
    float paths = float(parameters.max_path_length) * float(parameters.splitting_factor);
    return 65536u + uint(min(16.0 * paths, 1e9));
}

void start_counting_iterations() {
    // A loop over samples that never ends starts more of them than there are.
    if (samples_with_own_loops == 0u) return;
    --samples_with_own_loops;
    loop_iterations = 0u;
}

// Whether the loop at this place, as stuck_loop_text() reads it, has to end: it has gone on for too long, or another thread's has.
bool is_loop_stuck(uint place) {
    const uint look = 256u;  // iterations between two looks at the other threads
    uint limit = get_iteration_limit();
    ++loop_iterations;
    if (loop_iterations <= limit && loop_iterations % look != 0u) return false;
    uint stuck_place = atomicAdd(ray_counters[RAY_COUNTER_COUNT], 0u);
    if (stuck_place == 0u && loop_iterations <= limit) return false;
    if (stuck_place == 0u) ray_counters[RAY_COUNTER_COUNT] = place;
    loop_iterations = limit;  // all loops around it end, too
    return true;
}
