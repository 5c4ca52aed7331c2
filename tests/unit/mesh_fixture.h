// Mesh and material files for tests.
#pragma once
#include <algorithm>

#include "scene/scene.h"
#include "test_files.h"

namespace lab {

inline const std::string corners_of_a_square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

class MeshFile : public testing::Test {
  protected:
    Scene load(const std::string& obj, bool specular = false) const { return load_scene(folder.write("a.obj", obj), specular); }

    // A triangle of the material that these lines describe.
    Scene load_material(const std::string& lines, bool specular = false) const {
        folder.write("a.mtl", "newmtl m\n" + lines + "\n");
        return load("mtllib a.mtl\nusemtl m\n" + corners_of_a_square + "f 1 2 3\n", specular);
    }

    Material material(const std::string& lines, bool specular = false) const {
        return load_material(lines, specular).materials.at(0);
    }

    TestFolder folder;
};

inline size_t count_warnings(const Scene& scene, const std::string& part) {
    return static_cast<size_t>(std::count_if(scene.warnings.begin(), scene.warnings.end(), [&](const std::string& warning) {
        return warning.find(part) != std::string::npos;
    }));
}

}  // namespace lab
