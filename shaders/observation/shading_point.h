// The point whose hemisphere is shown. Shared by C++ and GLSL.
#ifdef __cplusplus
#include <shaders/interface.h>
namespace lab {
#endif

SHARED_CONSTANT BINDING_SHADING_POINT = 42u;

struct ShadingPoint {
    uint instance;
    uint triangle;  // index into the scene's triangles
    vec2 barycentrics;
    vec3 ray_direction;  // of the ray that hit it, unit length
    vec3 up;             // points upwards in the pictures, projected onto the surface
};

#ifdef __cplusplus
}  // namespace lab
#endif
