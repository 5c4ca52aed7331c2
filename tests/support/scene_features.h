// Enables the features of scenes, one at a time.
#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

struct SceneFeature {
    std::string name;
    void (*add)(Scene&);  // to a scene of one mesh and one instance without any feature
};

// All features of SceneFeatures. Absorption also adds a dielectric, which it needs; both apply to the last triangle only, so that
// paths stay the same.
const std::vector<SceneFeature>& all_scene_features();

}  // namespace lab
