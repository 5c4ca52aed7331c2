// A ray, and where it hits.

struct Ray {
    vec3 origin;     // x
    vec3 direction;  // ω, not necessarily of unit length
};

struct Hit {
    uint instance;
    uint triangle;      // index into the scene's triangles
    vec2 barycentrics;  // weights w_1 and w_2 of the second and third vertex; w_0 = 1 - w_1 - w_2
    float distance;     // hit point = origin + distance · direction
#ifdef FEATURE_DIELECTRICS
    uint material_class;
#endif
};

// t_max of a ray of unlimited length.
const float NO_LIMIT = 3.402823466e38;

// Rays traced by this invocation so far. Every trace_ray() and is_occluded() adds one.
uint ray_count = 0u;
