#include "../ray.glsl"
vec3 my_textures() { return vec3(0.25); }
