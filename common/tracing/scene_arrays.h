// What shaders read of a scene, as arrays on the host: GpuScene copies them to a device, dump_arrays writes them for browsers.
// Arrays that the scene does not need are not there.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "scene/features.h"
#include "scene/light_table.h"
#include "scene/light_tree.h"
#include "scene/scene.h"

namespace lab {

// How an estimator finds light: by light samples and bounces, weighted, or by only one of the two.
enum class Strategy { both, light, bounces };
inline constexpr std::array all_strategies{Strategy::both, Strategy::light, Strategy::bounces};
std::string to_string(Strategy strategy);

// What an estimator handles of a scene. Shaders know nothing of what else there is.
struct Capabilities {
    bool light_probe_sampling = false;  // light samples also go to a light probe
    bool dielectrics = false;
    bool microfacets = false;  // rough metal, plastic and glass (Pr)
    bool lens = false;         // has a camera with an aperture
    bool media = false;        // light scatters between surfaces, too
    bool light_tree = false;   // light samples choose a triangle by a tree over all of them
    bool light_paths = false;  // paths begin at lamps, too, where something of glass may focus their light
};

struct SceneArray {
    const char* name;
    uint32_t binding;
    std::span<const std::byte> data;
    uint32_t width = 0, height = 0;  // of an image
};

class SceneArrays {
  public:
    // Builds tables to sample lights from, unless only bounces find them. The scene must outlive the result.
    SceneArrays(const Scene& scene, Strategy strategy, const Capabilities& handles);
    SceneArrays(const SceneArrays&) = delete;
    SceneArrays& operator=(const SceneArrays&) = delete;

    // Positions and triangles come first.
    const std::vector<SceneArray>& buffers() const { return buffers_; }
    // Textures of four bytes a texel, then the light probe of four floats a texel.
    const std::vector<SceneArray>& images() const { return images_; }
    // What makes shaders/world/scene.glsl declare exactly these.
    const std::vector<std::string>& defines() const { return defines_; }

  private:
    template <typename T>
    void add(const char* name, uint32_t binding, const std::vector<T>& data) {
        buffers_.push_back({name, binding, std::as_bytes(std::span(data))});
    }
    void add_lights(const Scene& scene, const SceneFeatures& features, Strategy strategy, const Capabilities& handles);
    void add_images(const Scene& scene, const SceneFeatures& features);

    std::vector<SceneArray> buffers_, images_;
    std::vector<std::string> defines_;
    // What the scene itself does not hold.
    LightTable lights_;
    LightTree light_tree_;
    std::vector<ProbeCell> probe_cells_;
    std::vector<uvec2> texture_sizes_;
    std::vector<uint32_t> other_sides_;
    std::vector<float> probe_texels_;
};

}  // namespace lab
