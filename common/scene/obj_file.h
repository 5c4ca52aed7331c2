// Triangles from Wavefront .obj files.
#pragma once
#include <limits>

#include "scene/mtl_file.h"

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

}  // namespace lab
