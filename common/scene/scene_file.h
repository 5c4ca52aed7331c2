// Scene descriptions in JSON.
#pragma once
#include "scene/scene.h"
#include "scene/text_lines.h"

namespace lab {

struct MediumDescription {
    Medium medium;                  // without its grid, but with the box of that
    std::filesystem::path density;  // of the grid; empty where the density is 1
};

// One entry of "meshes".
struct MeshPlacement {
    std::filesystem::path file;
    std::filesystem::path materials;          // instead of those that the mesh names; empty: those
    std::optional<MediumDescription> medium;  // inside
    bool is_open = false;                     // its surface is none, and only the medium ends there
    glm::dmat4x3 object_to_world{1};          // translation * rotation * scale
};

// The contents of a scene file. The files it names are not read yet; their paths are relative to its folder.
struct SceneDescription {
    Scene scene;  // without the contents of those files
    std::vector<MeshPlacement> meshes;
    std::optional<MediumDescription> fog;
    std::filesystem::path light_probe;  // empty for a constant background
    bool has_camera = false;
    bool specular = false;
};

// Throws UserError naming the line of a syntax error, or the key that is unknown, missing, of the wrong type or out of range.
SceneDescription read_scene_file(const std::filesystem::path& file, SourceFiles& files);

}  // namespace lab
