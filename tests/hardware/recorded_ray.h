// A ray of the benchmark's estimator, as recorded and replayed. Shared by C++ and GLSL.
#ifdef __cplusplus
#include <shaders/interface.h>
namespace lab {
#endif

const uint BINDING_RECORDED_RAYS = 40u;
const uint MAX_RECORDED_RAYS = 17u;  // of a path of length 8: one a hit and one to the light

struct RecordedRay {
    vec3 origin;
    float t_max;
    vec3 direction;
    uint kind;  // NO_RAY, CLOSEST_HIT or OCCLUSION
};
const uint NO_RAY = 0u;
const uint CLOSEST_HIT = 1u;
const uint OCCLUSION = 2u;

#ifdef __cplusplus
}  // namespace lab
#endif
