// The references of the shipped scenes, and the settings at which they can be compared with a render.
#include "rendering/scene_reference.h"

#include <gtest/gtest.h>

#include "files/project_folder.h"
#include "scene/scene_file.h"

namespace lab {
namespace {

TEST(SceneReference, CanBeReachedFromAnySizeAndLength) {
    size_t found = 0;
    for (const auto& file : shipped_scenes()) {
        const Scene scene = load_scene(file);
        for (const uvec2 size : {uvec2(512), uvec2(768, 512), uvec2(33, 47)})
            for (const uint32_t length : {1u, 8u, 10000u}) {
                RenderParameters parameters = default_parameters(scene, size);
                parameters.max_path_length = length;
                const auto settings = settings_for_verdict(scene, parameters);
                if (!settings) continue;
                ++found;
                parameters = default_parameters(scene, settings->image_size);
                parameters.max_path_length = settings->max_path_length;
                const auto reference = find_reference(scene, parameters);
                EXPECT_TRUE(std::holds_alternative<Reference>(reference)) << file << ": " << std::get<std::string>(reference);
                parameters.only_path_length = 1;
                EXPECT_FALSE(settings_for_verdict(scene, parameters));
            }
    }
    EXPECT_GE(found, 9u * 14);
}

}  // namespace
}  // namespace lab
