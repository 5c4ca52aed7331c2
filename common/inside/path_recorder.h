// Follows a single path: what the estimator of a chapter, or of a student, does for one sample of a pixel.
#pragma once
#include <optional>
#include <vector>

#include "rendering/film.h"
#include "tracing/tracer.h"

namespace lab {

// A point on a light that a shadow ray was sent to.
struct LightSample {
    vec3 point;
    bool is_visible = false;
    vec3 radiance{0};  // that it added: throughput included
};

// Where a ray has hit something, or the direction in which it has left the scene.
struct PathVertex {
    int parent = -1;  // vertex that the ray came from; -1: the camera. Where paths split, several have one.
    vec3 origin;      // of the ray
    vec3 direction;   // of the ray, unit length
    bool is_hit = false;
    uint32_t instance = 0;
    uint32_t triangle = 0;  // index into the scene's triangles
    vec2 barycentrics{0};
    vec3 position{0};                           // of the hit
    vec3 normal{0};                             // for shading, on the ray's side
    vec3 throughput{1};                         // that the ray was traced with
    std::optional<float> survival_probability;  // of the Russian roulette that the ray has survived
    std::vector<LightSample> light_samples;
    vec3 radiance{0};                   // that was added here, throughput included, light samples as well
    std::vector<float> lost_roulettes;  // survival probabilities of paths that ended here
};

struct RecordedPath {
    vec3 radiance{0};                  // what the sample adds to the film
    std::vector<PathVertex> vertices;  // in the order of their rays; a parent comes before its children
    bool is_complete = true;           // false: there was no room for all of it
    bool has_throughput = false;       // the estimator has told one: it has a variable of that name
};

class PathRecorder {
  public:
    // The device and the acceleration structure must outlive it. Throws UserError if the estimator does not compile.
    PathRecorder(const Device& device, const AccelerationStructure& acceleration_structure, const Estimator& estimator,
                 uvec2 image_size);

    // Follows the sample with this index (counted as by first_sample), for the constructor's image size. The numbers are those of
    // a render with these parameters on the same backend.
    RecordedPath record(const RenderParameters& parameters, uvec2 pixel, uint32_t sample);

  private:
    const Device* device_;
    Film film_;
    Buffer parameters_, ray_counters_, events_;
    std::unique_ptr<Tracer> tracer_;
};

// The estimator, instrumented for recording.
Estimator recording(const Estimator& estimator);

}  // namespace lab
