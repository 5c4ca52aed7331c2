// The benchmark's estimator, reimplemented natively with Intel's Embree: the yardstick for our own traversal.
#pragma once
#include <memory>

#include "scene/scene.h"

namespace lab {

class EmbreeTwin {
  public:
    // The scene must outlive the twin.
    EmbreeTwin(const Scene& scene, const RenderParameters& parameters);
    ~EmbreeTwin();

    // Brings every pixel to this many samples, with two threads.
    void advance(uint32_t target_samples);

    // Mean radiance of the image so far.
    glm::dvec3 mean() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace lab
