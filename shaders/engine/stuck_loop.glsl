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
