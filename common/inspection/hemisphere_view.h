// What a shading point sees: the factors of the rendering equation's integrand over its hemisphere.
#pragma once
#include "inspection/path_recorder.h"
#include "rendering/renderer.h"

namespace lab {

// Pictures are equal-area discs: every pixel covers the solid angle 8/extent². The normal is in the middle, the horizon at the
// rim; the hemisphere is seen from above.
class HemisphereView {
  public:
    static constexpr uint32_t extent = 128;  // width and height of a picture in pixels

    // Device and acceleration structure must outlive it. Throws UserError if the estimator does not compile.
    HemisphereView(const Device& device, const SceneBackend& scene_backend, const Estimator& estimator);

    // Restarts at a vertex of a path, seen from where the path came. `parameters` are those of the render.
    void look_at(const PathVertex& vertex, const RenderParameters& parameters);
    // Renders one dispatch. Returns true until every pixel has this many samples.
    bool advance(uint32_t samples) { return renderer_.advance(samples); }
    double samples() const { return renderer_.samples(); }
    void set_dispatch_seconds(double seconds) { renderer_.set_dispatch_seconds(seconds); }

    struct Pictures {
        Image incoming_radiance;  // as the estimator finds it, with one bounce less than the render's paths
        Image brdf;               // 1/sr
        Image cosine;             // n·ω

        // Integral of their product over the hemisphere: the radiance that the point reflects.
        vec3 reflected_radiance() const;
    };
    Pictures pictures() const;

  private:
    Buffer point_;
    Renderer renderer_;
};

}  // namespace lab
