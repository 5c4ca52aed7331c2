// Scenes and settings in which one quantity grows: how does the cost follow it?
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

struct GrowthStep {
    uint64_t count;  // of the quantity, approximately as requested
    Scene scene;
    uvec2 image_size;
    uint32_t max_path_length;
};

struct Growth {
    std::string quantity;          // "triangles"
    std::string chapter;           // whose estimator renders
    std::vector<uint64_t> counts;  // the first is the one that the others are compared with
    std::function<GrowthStep(uint64_t)> make;
};

// For images of this width and height, unless these grow themselves.
std::vector<Growth> all_growths(uint32_t size);

}  // namespace lab
