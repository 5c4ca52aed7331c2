#version 460
// The path tracer as a compute shader: a workgroup renders samples of a block of pixels.
#include "interface.h"
#include "world/scene.glsl"

layout(scalar, push_constant) uniform DispatchParametersBlock { DispatchParameters dispatch; };

#include "world/ray.glsl"
#if defined(BACKEND_QUERY)
#include "engine/trace_ray/query.glsl"
#elif defined(BACKEND_EMBREE)
#include "engine/trace_ray/embree.glsl"
#else
#include "engine/trace_ray/compute.glsl"
#endif
#include "render_samples.glsl"

layout(local_size_x = BLOCK_SIZE) in;

void main() { render_pixel(gl_WorkGroupID.x * BLOCK_SIZE + gl_LocalInvocationIndex); }
