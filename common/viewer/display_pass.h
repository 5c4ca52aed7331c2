// Shows a film without reading it back: to_display() on the device.
#pragma once
#include <memory>

#include "film/film_image.h"
#include "gpu/compute_kernel.h"
#include "rendering/film.h"

namespace lab {

class DisplayPass {
  public:
    // Device and film must outlive the pass. A film of any size fills the picture.
    DisplayPass(const Device& device, const Film& film, std::shared_ptr<StorageImage> picture);

    // Updates the picture; pixels without samples stay as they were. `exposure` in stops.
    void record(const vk::raii::CommandBuffer& commands, DisplayTransform transform, float exposure) const;
    const StorageImage& picture() const { return *picture_; }
    const std::shared_ptr<StorageImage>& shared_picture() const { return picture_; }

  private:
    // A pass over the picture for each window of the film.
    void record_parts(const vk::raii::CommandBuffer& commands, DisplayParameters parameters) const;

    const Device* device_;
    const Film* film_;
    std::shared_ptr<StorageImage> picture_;
    Buffer largest_value_;
    ComputeKernel kernel_;
};

}  // namespace lab
