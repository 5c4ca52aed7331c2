// Scenes and settings of which one quantity grows: how does the cost follow it?
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

struct GrowthStep {
    uint64_t count;  // of the quantity, about what was asked for
    Scene scene;
    uvec2 image_size;
    uint32_t max_path_length;
};

struct Growth {
    std::string quantity;          // "triangles"
    std::string chapter;           // whose estimator renders
    std::vector<uint64_t> counts;  // the first is the one that all are compared with
    std::function<GrowthStep(uint64_t)> make;
};

// Of images of that width and height, where those do not grow themselves.
std::vector<Growth> all_growths(uint32_t size);

}  // namespace lab
