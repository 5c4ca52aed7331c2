// Switches the features of scenes on, one at a time.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

struct SceneFeature {
    std::string name;
    void (*add)(Scene&);  // to a scene of one mesh and one instance that has none of the features
};

// What SceneFeatures knows. Absorption brings a dielectric with it, which it needs; both are of the last
// triangle only, so that paths stay as they are.
const std::vector<SceneFeature>& all_scene_features();

}  // namespace lab
