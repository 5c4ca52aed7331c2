#version 460
// Closest-hit shader of a hit group: reports what was hit. There is one group per material class.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "world/ray.glsl"
#include "engine/trace_ray/pipeline_payload.glsl"

layout(location = HIT_PAYLOAD) rayPayloadInEXT Hit hit_payload;
hitAttributeEXT vec2 barycentrics;

layout(scalar, set = 0, binding = BINDING_GEOMETRY_FIRST_TRIANGLES) readonly buffer GeometryFirstTriangles {
    uint geometry_first_triangles[];  // two for each instance
};

void main() {
    uint first_triangle = geometry_first_triangles[2 * gl_InstanceCustomIndexEXT + gl_GeometryIndexEXT];
    hit_payload.instance = uint(gl_InstanceCustomIndexEXT);
    hit_payload.triangle = first_triangle + uint(gl_PrimitiveID);
    hit_payload.barycentrics = barycentrics;
    hit_payload.distance = gl_HitTEXT;
#ifdef FEATURE_DIELECTRICS
    hit_payload.material_class = MATERIAL_CLASS;
#endif
}
