uniform uint web_most_turns;  // of the loops of a sample, where fewer are allowed than in the programs
uint web_stuck_place = 0u;    // of a loop in this draw

// Whether the loop at this place, a number of the page's, has to end, as stuck_loop.glsl says. A draw then ends soon: a system takes the
// GPU away from one that goes on for seconds.
bool is_loop_stuck(uint place) {
    if (web_stuck_place == 0u && ++loop_iterations <= min(get_iteration_limit(), web_most_turns)) return false;
    if (web_stuck_place == 0u) web_stuck_place = place;
    return true;
}
