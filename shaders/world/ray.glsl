// The points origin + t · direction with 0 < t < t_max. Lengths are in scene units.
struct Ray {
    vec3 origin;     // x, in scene units
    vec3 direction;  // ω, not necessarily of unit length
};

// Where a ray hits a triangle.
struct Hit {
    uint instance;      // index into the scene's placements of meshes
    uint triangle;      // index into the scene's triangles
    vec2 barycentrics;  // weights w_1 and w_2 of the second and third vertex; w_0 = 1 - w_1 - w_2
    float distance;     // t of the hit point: in scene units if the direction has unit length
#ifdef FEATURE_DIELECTRICS
    uint material_class;  // how the surface scatters light: MATERIAL_CLASS_DIFFUSE or MATERIAL_CLASS_DIELECTRIC
#endif
};

// The t_max of a ray without an end.
const float NO_LIMIT = 3.402823466e38;

// Rays traced by this invocation so far. Every trace_ray() and is_occluded() adds one.
uint ray_count = 0u;
