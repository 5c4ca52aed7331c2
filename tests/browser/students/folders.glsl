// helper files with names of the engine
#include "ray.glsl"
#include "lights.glsl"
#include "sub/textures.glsl"
vec3 path_trace(Ray ray, inout uvec2 seed) { return my_ray() + my_lights() + my_textures(); }
