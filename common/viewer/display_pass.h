// Shows a film on the device: the transform of film/display.h, without reading anything back.
#pragma once
#include <memory>

#include "film/film_image.h"
#include "gpu/compute_kernel.h"
#include "rendering/film.h"

namespace lab {

class DisplayPass {
  public:
    // Device and film must outlive the pass. The film, whatever its size, fills the picture.
    DisplayPass(const Device& device, const Film& film, std::shared_ptr<StorageImage> picture);

    // Brings the picture up to date; where the film has no samples yet the picture stays as it was.
    // `exposure` in stops.
    void record(const vk::raii::CommandBuffer& commands, DisplayTransform transform, float exposure) const;
    const StorageImage& picture() const { return *picture_; }
    const std::shared_ptr<StorageImage>& shared_picture() const { return picture_; }

  private:
    // One pass over the picture for each part of the film that can be seen at a time.
    void record_parts(const vk::raii::CommandBuffer& commands, DisplayParameters parameters) const;

    const Device* device_;
    const Film* film_;
    std::shared_ptr<StorageImage> picture_;
    Buffer largest_value_;
    ComputeKernel kernel_;
};

}  // namespace lab
