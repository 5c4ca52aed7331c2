// Materials from Wavefront .mtl files.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "scene/text_lines.h"
#include "shaders/interface.h"

namespace lab {

// A material as its file states it: Kd + Ks may exceed 1, and albedo_texture is not set yet.
struct MtlMaterial {
    std::string name;
    Material material;
    std::filesystem::path albedo_texture;  // map_Kd, or empty
    Microfacets microfacets{};             // from Pr, Pm and Ni, without albedos
};

// Reads Kd, map_Kd, Ke, Ks and Ns as in Material; Kd defaults to white if there is map_Kd. d < 1 or Tr > 0 (= 1 - d) makes a
// smooth dielectric of refractive index Ni in [0.01,100] that absorbs -ln Tf per unit of length (nothing without Tf). Pr in [0,1]
// makes a dielectric rough, unless it is below smallest_roughness, and an opaque material metal to the fraction Pm, for the rest
// diffuse under a coat of index Ni (default 1.5), without Ks. A warning names keywords without effect. Textures are relative to
// texture_folder. Throws UserError for numbers that are missing, not finite or out of range, such as Tf 0.
std::vector<MtlMaterial> read_mtl(const std::filesystem::path& file, const std::filesystem::path& texture_folder,
                                  SourceFiles& files, std::vector<std::string>& warnings);

}  // namespace lab
