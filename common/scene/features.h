// What a scene needs. Each feature becomes a #define; absent features cost no instruction, buffer or binding.
#pragma once
#include <algorithm>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace lab {

struct SceneFeatures {
    bool vertex_normals = false;
    bool textures = false;
    bool sky = false;  // constant background other than black
    bool light_probe = false;
    bool area_lights = false;  // some triangle emits; the define depends on the estimator, see GpuScene
    bool dielectrics = false;
    bool absorption = false;
    bool double_sided = false;  // some emissive triangle has another one as its back
    bool transforms = false;    // some instance is moved, turned or scaled
    bool microfacets = false;   // the defines depend on the estimator, see GpuScene
    bool lens = false;          // the camera has an aperture
    bool media = false;         // something scatters light between surfaces; the defines depend on the estimator, see GpuScene
    std::vector<std::string> lobes;  // defines of those lobes that some material has, such as FEATURE_SPECULAR

    bool specular() const { return std::ranges::count(lobes, "FEATURE_SPECULAR") > 0; }  // the Phong lobe
    // FEATURE_VERTEX_NORMALS and so on, for the features present.
    std::vector<std::string> defines() const;
};

SceneFeatures features_of(const Scene& scene);

}  // namespace lab
