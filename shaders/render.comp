#version 460
// A path tracer in a compute shader: a workgroup renders a block of pixels.
#include "interface.h"
#include "scene.glsl"

layout(scalar, push_constant) uniform DispatchParametersBlock { DispatchParameters dispatch; };

#include "ray.glsl"
#ifdef BACKEND_QUERY
#include "trace_ray/query.glsl"
#else
#include "trace_ray/compute.glsl"
#endif
#include "render_pixel.glsl"

layout(local_size_x = BLOCK_WIDTH, local_size_y = BLOCK_HEIGHT) in;

void main() { render_pixel(dispatch.first_block + gl_WorkGroupID.x, gl_LocalInvocationID.xy, dispatch.target_samples); }
