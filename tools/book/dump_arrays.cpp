// Writes what a browser needs to render a scene as a chapter does: the arrays that a GPU gets, our hierarchy, the parameters and
// the reference, if there is one, and what moving the camera takes. FILE.json says where each array of FILE.bin begins; all
// numbers have 32 bits.
//     dump_arrays FILE CHAPTER SCENE OPTIONS
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/all_backends.h"
#include "error.h"
#include "platform.h"
#include "rendering/render_job.h"
#include "rendering/scene_reference.h"
#include "rendering/settings.h"
#include "tracing/bvh.h"

namespace {

using namespace lab;
using nlohmann::json;

constexpr uint32_t width = 256;  // about that of the pictures

class Dump {
  public:
    explicit Dump(const std::string& file) : text_(file + ".json"), words_(file + ".bin", std::ios::binary) {}

    template <typename T>
    void add(const char* list, json entry, const T& data) {
        const auto bytes = std::as_bytes(std::span(data));
        entry["first"] = size_;
        entry["count"] = bytes.size() / 4;
        // Texels of the browser's texture have four words.
        const std::vector<char> padding((16 - bytes.size() % 16) % 16);
        words_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        words_.write(padding.data(), static_cast<std::streamsize>(padding.size()));
        size_ += (bytes.size() + padding.size()) / 4;
        content[list].push_back(std::move(entry));
    }

    void close() {
        text_ << content.dump();
        text_.close();
        words_.close();
        if (!text_ || !words_) throw UserError("the arrays could not be written: is there room in the folder?");
    }

    json content = json::object();

  private:
    std::ofstream text_, words_;
    size_t size_ = 0;  // words so far
};

// The picture of this scene that has a reference for the wanted path length, or else the one that the options describe.
RenderParameters picture(const Chapter& chapter, const Scene& scene, Options options) {
    const RenderParameters asked = make_parameters(chapter, scene, options);
    options.image.width = options.image.height = width;
    const auto settings = settings_for_verdict(scene, make_parameters(chapter, scene, options));
    if (!settings) return asked;
    options.image.width = settings->image_size.x;
    options.image.height = settings->image_size.y;
    options.light.max_path_length = settings->max_path_length;
    return make_parameters(chapter, scene, options);
}

void dump(const std::string& file, const Chapter& chapter, const Options& options) {
    const std::shared_ptr<const Scene> loaded = load_scene_for(chapter, options.scene);
    const Scene& scene = *loaded;
    const RenderParameters parameters = picture(chapter, scene, options);
    const SceneArrays arrays(scene, strategy_of(chapter, options), chapter.handles);
    const Bvh bvh = build_bvh(world_triangles(scene));
    const Bounds bounds = world_bounds(scene);
    const float diagonal = glm::distance(bounds.low, bounds.high);

    Dump dump(file);
    dump.content = {{"defines", arrays.defines()},
                    {"options", make_estimator(chapter, options).defines},
                    {"camera", {{"up", {scene.camera.up.x, scene.camera.up.y, scene.camera.up.z}}, {"scene_size", diagonal}}},
                    {"buffers", json::array()},
                    {"images", json::array()}};
    dump.content["defines"].push_back("BVH_STACK_SIZE " + std::to_string(bvh.stack_size()));
    for (const SceneArray& array : arrays.buffers()) dump.add("buffers", {{"binding", array.binding}}, array.data);
    dump.add("buffers", {{"binding", BINDING_BVH_NODES}}, std::span<const BvhNode>(bvh.nodes));
    dump.add("buffers", {{"binding", BINDING_BVH_TRIANGLES}}, std::span<const BvhTriangle>(bvh.triangles));
    for (const SceneArray& image : arrays.images())
        dump.add("images", {{"binding", image.binding}, {"width", image.width}, {"height", image.height}}, image.data);
    dump.add("parameters", json::object(), std::span(&parameters, 1));
    const auto reference = find_reference(scene, parameters);
    if (const auto* found = std::get_if<Reference>(&reference))
        for (const Image* image : {&found->mean, &*found->variance})
            dump.add("reference",
                     {{"width", image->width}, {"height", image->height}, {"samples", found->attributes.at("samples")}},
                     image->pixels);
    dump.close();
}

}  // namespace

int main(int argument_count, char** arguments) {
    lab::prepare_program();
    try {
        if (argument_count < 4) throw lab::UserError("dump_arrays needs FILE CHAPTER SCENE OPTIONS");
        const lab::Chapter chapter = lab::load_chapter(arguments[2]);
        const auto options = lab::parse_options(chapter, lab::all_backends, {arguments + 3, arguments + argument_count});
        if (options) dump(arguments[1], chapter, *options);
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "error: " << error.what() << "\n";
        return 1;
    }
}
