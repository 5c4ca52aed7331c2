// A ray of an estimator, as recorded and replayed. Shared by C++ and GLSL.
#ifdef __cplusplus
#include <shaders/interface.h>
namespace lab {
#endif

const uint BINDING_RECORDED_RAYS = 40u;
// Two slots per segment of a path of length 8: the ray to the hit, and the one from there to a light. So threads replay rays of
// one kind together, just as they traced them.
const uint MAX_RECORDED_RAYS = 18u;

struct RecordedRay {
    vec3 origin;
    float t_max;
    vec3 direction;
    uint is_recorded;  // 0 or 1
};

#ifdef __cplusplus
}  // namespace lab
#endif
