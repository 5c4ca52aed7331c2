// The bounding volume hierarchy (BVH) built by common/tracing/bvh.cpp, in texels of 16 bytes.
// A node takes eight: low x, high x, low y, high y, low z, high z of its four children, and references to them.
// A triangle takes three: x, y and z of its vertices; the fourth components hold instance, triangle and nothing.

#ifdef BVH_IN_STORAGE_BUFFERS  // where texel buffers are too small; most devices read those faster
#extension GL_EXT_scalar_block_layout : require
layout(scalar, set = 0, binding = BINDING_BVH_NODES) readonly buffer BvhNodes { uvec4 bvh_nodes[]; };
layout(scalar, set = 0, binding = BINDING_BVH_TRIANGLES) readonly buffer BvhTriangles { uvec4 bvh_triangles[]; };
uvec4 fetch_node_texel(int index) { return bvh_nodes[index]; }
uvec4 fetch_triangle_texel(int index) { return bvh_triangles[index]; }
#else
#extension GL_EXT_samplerless_texture_functions : require
layout(set = 0, binding = BINDING_BVH_NODES) uniform utextureBuffer bvh_nodes;
layout(set = 0, binding = BINDING_BVH_TRIANGLES) uniform utextureBuffer bvh_triangles;
uvec4 fetch_node_texel(int index) { return texelFetch(bvh_nodes, index); }
uvec4 fetch_triangle_texel(int index) { return texelFetch(bvh_triangles, index); }
#endif

vec4 fetch_node_row(int row) { return uintBitsToFloat(fetch_node_texel(row)); }
vec3 fetch_triangle_row(int row) { return uintBitsToFloat(fetch_triangle_texel(row).xyz); }
