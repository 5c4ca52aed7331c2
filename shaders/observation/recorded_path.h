// The steps of an estimator for one sample of one pixel, in order. Shared by C++ and GLSL.
#ifdef __cplusplus
#include <shaders/interface.h>
namespace lab {
#endif

SHARED_CONSTANT BINDING_RECORDED_PATH = 41u;

SHARED_CONSTANT EVENT_RAY = 0u;                // trace_ray()
SHARED_CONSTANT EVENT_SHADOW_RAY = 1u;         // is_occluded()
SHARED_CONSTANT EVENT_THROUGHPUT_STARTS = 2u;  // a declaration of `throughput`: a path or a branch begins
SHARED_CONSTANT EVENT_THROUGHPUT = 3u;         // an assignment to it
SHARED_CONSTANT EVENT_RADIANCE_STARTS = 4u;    // a declaration of `radiance`
SHARED_CONSTANT EVENT_RADIANCE = 5u;           // an assignment to it
SHARED_CONSTANT EVENT_SURVIVAL = 6u;           // the value of `survival_probability`
SHARED_CONSTANT EVENT_RESULT = 7u;             // what finish_sample() got
SHARED_CONSTANT EVENT_START = 8u;              // start_sample(): a path begins, and of two the one from the lamp comes first
SHARED_CONSTANT EVENT_SPLAT = 9u;              // add_splat()

SHARED_NUMBER NO_FLIGHT = -1.0f;

struct RecordedEvent {
    uint kind;
    // For radiance: which variable of this name, numbered from 1 through the text; 0 is a struct's member.
    uint variable;
    vec3 value;  // of throughput and radiance after the assignment, or survival probability

    vec3 origin;  // of a ray
    vec3 direction;
    float end;     // of a ray, in lengths of its direction: t_max
    float flight;  // of a path in a medium: where it ends unless a surface is nearer. NO_FLIGHT: none was sampled
    uint is_hit;   // 0 or 1
    // For hits, except those of shadow rays.
    uint instance;
    uint triangle;  // index into the scene's triangles
    vec2 barycentrics;
    vec3 position;
    vec3 normal;  // for shading, on the ray's side
};

#ifdef __cplusplus
}  // namespace lab
#endif
