#version 460
// A path tracer in a compute shader: a workgroup renders one sample of each pixel of a block.
#include "interface.h"
#include "scene.glsl"

layout(scalar, push_constant) uniform DispatchParametersBlock { DispatchParameters dispatch; };

#include "ray.glsl"
#ifdef BACKEND_QUERY
#include "trace_ray/query.glsl"
#else
#include "trace_ray/compute.glsl"
#endif
#include "render_sample.glsl"

layout(local_size_x = BLOCK_SIZE) in;

void main() { render_sample(gl_WorkGroupID.x * BLOCK_SIZE + gl_LocalInvocationIndex); }
