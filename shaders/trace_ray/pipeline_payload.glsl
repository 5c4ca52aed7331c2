// What the shaders of the ray tracing pipeline agree on.
#extension GL_EXT_ray_tracing : require

const int HIT_PAYLOAD = 0;
const int SHADOW_PAYLOAD = 1;
const uint MISS_RECORD = 0u;
const uint SHADOW_MISS_RECORD = 1u;
const uint NO_TRIANGLE = 0xffffffffu;
