// trace_ray() by ray queries: any shader can traverse the driver's acceleration structure.
#extension GL_EXT_ray_query : require

layout(set = 0, binding = BINDING_ACCELERATION_STRUCTURE) uniform accelerationStructureEXT acceleration_structure;
layout(scalar, set = 0, binding = BINDING_GEOMETRY_FIRST_TRIANGLES) readonly buffer GeometryFirstTriangles {
    uint geometry_first_triangles[];  // two for each instance
};

// Finds the closest hit nearer than t_max, and returns whether there is one.
bool trace_ray(Ray ray, float t_max, out Hit hit) {
    ++ray_count;
    rayQueryEXT query;
    rayQueryInitializeEXT(query, acceleration_structure, gl_RayFlagsOpaqueEXT, 0xffu, ray.origin, 0.0, ray.direction,
                          t_max);
    // All triangles are opaque, so a single call traverses the whole structure.
    rayQueryProceedEXT(query);
    if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) return false;
    hit.instance = rayQueryGetIntersectionInstanceCustomIndexEXT(query, true);
    uint geometry = 2u * hit.instance + rayQueryGetIntersectionGeometryIndexEXT(query, true);
    hit.triangle = geometry_first_triangles[geometry] + rayQueryGetIntersectionPrimitiveIndexEXT(query, true);
    hit.barycentrics = rayQueryGetIntersectionBarycentricsEXT(query, true);
    hit.distance = rayQueryGetIntersectionTEXT(query, true);
#ifdef FEATURE_DIELECTRICS
    hit.material_class = get_material_class(hit.triangle);
#endif
    return true;
}

// Whether anything is hit nearer than t_max. Any hit will do.
bool is_occluded(Ray ray, float t_max) {
    ++ray_count;
    rayQueryEXT query;
    rayQueryInitializeEXT(query, acceleration_structure, gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT,
                          0xffu, ray.origin, 0.0, ray.direction, t_max);
    rayQueryProceedEXT(query);
    return rayQueryGetIntersectionTypeEXT(query, true) != gl_RayQueryCommittedIntersectionNoneEXT;
}
