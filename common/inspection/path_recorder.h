// Follows a single path: what a chapter's or a student's estimator does for one sample of a pixel.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "rendering/film.h"
#include "shaders/observation/recorded_path.h"
#include "tracing/tracer.h"

namespace lab {

struct Sphere {
    vec3 centre;
    float radius;
};

// What a shadow ray was sent to.
struct LightSample {
    vec3 start;                 // of its ray: at a vertex, or anywhere along a ray in a medium
    vec3 direction;             // unit length
    std::optional<vec3> point;  // on a light, or null: the sky
    bool is_visible = false;
    vec3 radiance{0};              // contribution, throughput included
    std::vector<Sphere> branch{};  // nodes of the light tree that lead to the light, from LightBranches
};

// Where a ray hit something or a free flight along it ended in a medium, or the direction in which it left the scene.
struct PathVertex {
    int parent = -1;            // vertex that the ray came from; -1: the camera. Where paths split, several have the same.
    vec3 origin;                // of the ray
    vec3 direction;             // of the ray, unit length
    bool is_hit = false;        // at a surface
    bool is_collision = false;  // in a medium
    uint32_t instance = 0;
    uint32_t triangle = 0;  // index into the scene's triangles
    vec2 barycentrics{0};
    vec3 position{0};                           // of the hit or collision
    vec3 normal{0};                             // for shading, on the ray's side
    vec3 throughput{1};                         // that the ray carried
    std::optional<float> survival_probability;  // of the Russian roulette that the ray survived
    std::vector<LightSample> light_samples;
    vec3 radiance{0};                   // added here, by light samples as well, throughput included
    std::vector<float> lost_roulettes;  // survival probabilities of paths that ended here

    bool is_in_scene() const { return is_hit || is_collision; }
};

struct RecordedPath {
    vec3 radiance{0};                  // contribution of the sample to the film
    std::vector<PathVertex> vertices;  // in the order of their rays; a parent comes before its children
    // Of the path from a lamp beside it, in the same order, if there is one: its light samples go to the camera, and their
    // radiance to the pixel that sees them.
    std::vector<PathVertex> light_path;
    bool is_complete = true;      // false: there was not enough room for all of it
    bool has_throughput = false;  // whether the estimator has a variable of that name
};

// The path that events make. `is_complete` is left to the recorder.
RecordedPath path_of(std::span<const RecordedEvent> events);

class PathRecorder {
  public:
    // Device and acceleration structure must outlive it. Throws UserError if the estimator does not compile.
    PathRecorder(const Device& device, const SceneBackend& scene_backend, const Estimator& estimator,
                 const RenderParameters& parameters);

    // Records the sample with this index (counted from first_sample), with the constructor's image_size and splat_unit. Its
    // values are those of a render with these parameters on the same backend. Throws StuckLoop as Renderer::advance() does.
    RecordedPath record(const RenderParameters& parameters, uvec2 pixel, uint32_t sample);

  private:
    Estimator estimator_;
    Film film_;
    Buffer parameters_, ray_counters_, events_;
    std::unique_ptr<Tracer> tracer_;
};

// The estimator, instrumented for recording.
Estimator recording(const Estimator& estimator);

}  // namespace lab
