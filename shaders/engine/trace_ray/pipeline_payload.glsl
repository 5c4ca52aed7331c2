// The payload that all shaders of the ray tracing pipeline share.
#extension GL_EXT_ray_tracing : require

// For all rays: a separate payload for shadow rays costs up to 15 % of the rays per second, see docs/backends.md.
const int HIT_PAYLOAD = 0;
const uint MISS_RECORD = 0u;
const uint NO_TRIANGLE = 0xffffffffu;
