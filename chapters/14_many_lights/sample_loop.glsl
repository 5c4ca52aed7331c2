#include "10_path_regeneration/sample_loop.glsl"
