// What a window renders with: everything that takes long to make, so that a thread of its own makes it.
#pragma once
#include <set>

#include "rendering/build.h"
#include "viewer/display_pass.h"

namespace lab {

struct WindowBuild : Build {
    std::set<std::filesystem::path> shader_files;
    uint64_t shader_hash = 0;  // of their contents
    std::unique_ptr<DisplayPass> display;
};

// As make_build(), and what shows the film.
std::unique_ptr<WindowBuild> make_window_build(const Device& device, const Chapter& chapter, RenderJob job,
                                               BuildStage first = BuildStage::scene,
                                               const WindowBuild* before = nullptr);

// Hash of the contents of all files; 0 if one cannot be read now, as while an editor replaces it.
uint64_t hash_of(const std::set<std::filesystem::path>& files);

}  // namespace lab
