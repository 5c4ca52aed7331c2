// Triangles from Wavefront .obj files.
#pragma once
#include <limits>

#include "scene/mtl_file.h"
#include "scene/scene.h"

namespace lab {

// A corner of a triangle: indices into the arrays of an ObjFile. All but the position may be absent.
struct ObjCorner {
    static constexpr uint32_t none = std::numeric_limits<uint32_t>::max();
    uint32_t position = none;
    uint32_t texture_coordinates = none;
    uint32_t normal = none;
    bool operator==(const ObjCorner&) const = default;
};

// The contents of an .obj file, polygons cut into triangles. All numbers are finite, all indices in range.
struct ObjFile {
    std::string file;
    std::vector<vec3> positions;
    std::vector<vec2> texture_coordinates;  // as in the file: v points up
    std::vector<vec3> normals;              // as in the file: of any length
    std::vector<ObjCorner> corners;         // three a triangle, at least one triangle
    std::vector<uint32_t> triangle_materials;
    std::vector<uint32_t> triangle_lines;  // of the file, counted from 1
    std::vector<MtlMaterial> materials;
};

// UserError naming the line for coordinates that are not finite numbers, indices out of range and faces of
// fewer than 3 or more than 256 corners. Faces without a material, or with one that is nowhere, get a grey
// one (Kd 0.5), with a warning.
ObjFile read_obj(const std::filesystem::path& file, SourceFiles& files, std::vector<std::string>& warnings);

// Fills the scene's vertices, triangles, materials, textures and meshes (one a file). Corners with the same
// position, normal and texture coordinates become one vertex; triangles without area are left out, and so are
// materials without triangles. Calls resolve_coincident_lights() for each mesh. Reads the textures. UserError
// for damaged textures and for files in which no triangle has an area. Returns the line of its file for each
// of the scene's triangles.
std::vector<uint32_t> assemble_meshes(const std::vector<ObjFile>& files, bool specular, SourceFiles& sources,
                                      Scene& scene);

}  // namespace lab
