// A thread whose path has ended replays its next one at once, so that no rate is limited by waiting.
#include "10_path_regeneration/sample_loop.glsl"
