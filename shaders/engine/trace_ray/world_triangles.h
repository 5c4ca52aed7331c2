// What the backend `native` keeps of each triangle, for C++ and GLSL.
#ifdef __cplusplus
#include <shaders/interface.h>
namespace lab {
#endif
SHARED_CONSTANT BINDING_WORLD_TRIANGLES = 32u;
SHARED_CONSTANT BINDING_FIRST_WORLD_TRIANGLES = 33u;

// A triangle of an instance as rays meet it, 64 bytes. What get_surface_point() needs to compute but once.
struct WorldTriangle {
    mat3 corners;  // columns: positions
    vec3 normal;   // geometric, unit length, on the front
    vec3 offsets;  // at the corners, as SurfacePoint has it
    uint padding;
};
#ifdef __cplusplus
}  // namespace lab
#endif
