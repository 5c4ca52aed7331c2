// The scene's arrays on the device. Arrays that a scene does not need are not declared.
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_nonuniform_qualifier : require
#extension GL_EXT_samplerless_texture_functions : require

layout(scalar, set = 0, binding = BINDING_RENDER_PARAMETERS) uniform RenderParametersBlock {
    RenderParameters parameters;
};
layout(scalar, set = 0, binding = BINDING_POSITIONS) readonly buffer Positions { vec3 positions[]; };
layout(scalar, set = 0, binding = BINDING_TRIANGLES) readonly buffer Triangles { uvec3 triangles[]; };
layout(scalar, set = 0, binding = BINDING_TRIANGLE_MATERIALS) readonly buffer TriangleMaterials {
    uint triangle_materials[];
};
layout(scalar, set = 0, binding = BINDING_MATERIALS) readonly buffer Materials { Material materials[]; };
// The roughness, reflectances and coat of each material, by its index.
#ifdef FEATURE_MICROFACETS
layout(scalar, set = 0, binding = BINDING_MICROFACETS) readonly buffer MicrofacetsOfMaterials { Microfacets microfacets[]; };
#endif
// Media, the first of which lies outside of all bodies.
#ifdef FEATURE_MEDIA
layout(scalar, set = 0, binding = BINDING_MEDIA) readonly buffer Media { Medium media[]; };
#endif
// Grids of media, x fastest, one after the other.
#ifdef FEATURE_DENSITIES
layout(scalar, set = 0, binding = BINDING_DENSITIES) readonly buffer Densities { float densities[]; };
#endif
// What lies on the two sides of bodies.
#ifdef FEATURE_BOUNDARIES
layout(scalar, set = 0, binding = BINDING_BOUNDARIES) readonly buffer Boundaries { Boundary boundaries[]; };
layout(scalar, set = 0, binding = BINDING_BOUNDARY_PLACES) readonly buffer BoundaryPlaces {
    uint boundary_places[];  // a triangle's place in boundaries: the sum of one entry per triangle and one per instance
};
#endif
#ifdef FEATURE_OVERLAPS
layout(scalar, set = 0, binding = BINDING_OVERLAPS) readonly buffer Overlaps {
    uint overlaps[];  // bodies that overlap with others, whose boundaries know where theirs begin
};
#endif
#ifdef FEATURE_VERTEX_NORMALS
layout(scalar, set = 0, binding = BINDING_NORMALS) readonly buffer Normals { vec3 normals[]; };
#endif
#ifdef FEATURE_TEXTURES
layout(scalar, set = 0, binding = BINDING_TEXTURE_COORDINATES) readonly buffer TextureCoordinates {
    vec2 texture_coordinates[];
};
layout(set = 0, binding = BINDING_TEXTURES) uniform texture2D textures[TEXTURE_COUNT];
layout(scalar, set = 0, binding = BINDING_TEXTURE_SIZES) readonly buffer TextureSizes { uvec2 texture_sizes[]; };
#endif
#ifdef FEATURE_DOUBLE_SIDED
layout(scalar, set = 0, binding = BINDING_OTHER_SIDES) readonly buffer OtherSides {
    uint other_sides[];  // per triangle: the one that is its back, or itself
};
#endif
#ifdef FEATURE_TRANSFORMS
layout(scalar, set = 0, binding = BINDING_INSTANCES) readonly buffer Instances { Instance instances[]; };
#endif
#ifdef FEATURE_LIGHT_TRIANGLES
layout(scalar, set = 0, binding = BINDING_LIGHT_TRIANGLES) readonly buffer LightTriangles {
    LightTriangle light_triangles[];
};
#endif
#ifdef FEATURE_LIGHT_TREE
layout(scalar, set = 0, binding = BINDING_LIGHT_NODES) readonly buffer LightNodes {
    LightNode light_nodes[];  // of the tree over emissive triangles; its root comes first
};
layout(scalar, set = 0, binding = BINDING_LIGHT_LEAVES) readonly buffer LightLeaves {
    LightLeaf light_leaves[];  // what a ray that hits an emissive triangle needs to know; see ShadingData.light
};
layout(scalar, set = 0, binding = BINDING_LIGHT_PLACES) readonly buffer LightPlaces {
    uint light_places[];  // an emissive triangle's place in light_leaves: the sum of one entry per triangle and one per instance
};
#endif
#ifdef FEATURE_LIGHT_PROBE_CELLS
layout(scalar, set = 0, binding = BINDING_PROBE_CELLS) readonly buffer ProbeCells { ProbeCell probe_cells[]; };
#endif
#ifdef FEATURE_LIGHT_PROBE
layout(set = 0, binding = BINDING_LIGHT_PROBE) uniform texture2D light_probe;
#endif

#ifdef FEATURE_DIELECTRICS
uint get_material_class(uint triangle) {
    bool is_dielectric = materials[triangle_materials[triangle]].refractive_index > 0.0;
    return is_dielectric ? MATERIAL_CLASS_DIELECTRIC : MATERIAL_CLASS_DIFFUSE;
}
#endif

#ifdef FEATURE_BOUNDARIES
// The boundary that a triangle of an instance belongs to. Its kind is BOUNDARY_NONE if it bounds nothing.
Boundary get_boundary(uint instance, uint triangle) {
    return boundaries[boundary_places[triangle] + boundary_places[uint(triangles.length()) + instance]];
}
#endif

#ifdef FEATURE_MEDIA
// The medium with this index. Where the compiler sees that there is no other, it is not loaded for each path.
Medium get_medium(uint index) {
#ifdef FEATURE_BOUNDARIES
    return media[index];
#else
    return media[0];
#endif
}
#endif
