#version 460
// A path tracer in a compute shader: a workgroup renders samples of a block of pixels.
#include "interface.h"
#include "scene.glsl"

layout(scalar, push_constant) uniform DispatchParametersBlock { DispatchParameters dispatch; };

#include "ray.glsl"
#ifdef BACKEND_QUERY
#include "trace_ray/query.glsl"
#else
#include "trace_ray/compute.glsl"
#endif
#include "render_samples.glsl"

layout(local_size_x = BLOCK_SIZE) in;

void main() { render_samples(gl_WorkGroupID.x * BLOCK_SIZE + gl_LocalInvocationIndex); }
