// A thread whose path has ended replays its next one at once, so that waiting never limits the rate.
#include "10_path_regeneration/sample_loop.glsl"
