// Wavefront .obj files, and the scene arrays made from them.
#pragma once
#include <limits>

#include "scene/mtl_file.h"
#include "scene/scene.h"

namespace lab {

// Indices into the arrays of an ObjFile; all but the position may be absent.
struct ObjCorner {
    static constexpr uint32_t none = std::numeric_limits<uint32_t>::max();
    uint32_t position = none;
    uint32_t texture_coordinates = none;
    uint32_t normal = none;
    bool operator==(const ObjCorner&) const = default;
};

// An .obj file whose polygons are cut into triangles. All numbers are finite, all indices in range.
struct ObjFile {
    std::string file;
    std::vector<vec3> positions;
    std::vector<vec2> texture_coordinates;  // as in the file: v points up
    std::vector<vec3> normals;              // as in the file: of any length
    std::vector<ObjCorner> corners;         // three per triangle, at least one triangle
    std::vector<uint32_t> triangle_materials;
    std::vector<uint32_t> triangle_lines;  // of the file, counted from 1
    std::vector<MtlMaterial> materials;
};

// Reads an .obj file and its material files. Throws UserError, naming the line, for coordinates that are not finite numbers,
// indices out of range, and faces of fewer than 3 or more than 256 corners. Faces without a known material become grey (Kd 0.5),
// with a warning. If `materials` is not empty, it is read instead of the material files that the mesh names, and if it has a
// single material, all faces are of it.
ObjFile read_obj(const std::filesystem::path& file, const std::filesystem::path& materials, SourceFiles& files,
                 std::vector<std::string>& warnings);

// Fills the scene's vertices, triangles, materials, textures and meshes (one per file), and reads textures. Equal corners become
// one vertex; triangles without area and materials without triangles are dropped; coincident lights are resolved. Throws
// UserError for damaged textures and for files in which no triangle has an area.
void assemble_meshes(const std::vector<ObjFile>& files, bool specular, SourceFiles& sources, Scene& scene);

}  // namespace lab
