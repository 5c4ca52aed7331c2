// Files beside the estimator, with names that the engine has and that no chapter replaces.
#include "film.glsl"
#include "blocks.glsl"
vec3 path_trace(Ray ray, inout uvec2 seed) { return get_film() + get_blocks(ray.direction); }
