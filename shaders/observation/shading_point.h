// The point whose hemisphere is looked at. Shared by C++ and GLSL.
#ifdef __cplusplus
#include <shaders/interface.h>
namespace lab {
#endif

SHARED_CONSTANT BINDING_SHADING_POINT = 42u;

struct ShadingPoint {
    uint instance;
    uint triangle;  // index into the scene's triangles
    vec2 barycentrics;
    vec3 ray_direction;  // of the ray that has hit it, unit length
    vec3 up;             // what is upwards in the pictures as far as it lies in the surface
};

#ifdef __cplusplus
}  // namespace lab
#endif
