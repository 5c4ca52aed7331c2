// The keywords of a material in .mtl files, for all that know them: the reader in mtl_file.cpp, the features of a scene, the
// references (tools/references/meshes.py) and docs/scenes.md, whose table repeats these lines.
#pragma once
#include <limits>

#include "shaders/interface.h"

namespace lab {

// For keywords whose numbers go to the shaders as they are.
struct MaterialMember {
    vec3 Material::*colour = nullptr;
    float Material::*number = nullptr;
    float default_number = 0;       // colours are black
    bool is_albedo = false;         // those of a material are divided by their sum if that exceeds 1
    const char* feature = nullptr;  // the define for scenes where some material's is not black
};

struct MaterialKeyword {
    const char* name;
    int count;      // of the numbers that follow: 1 or 3, of which one stands for three equal ones; 0: other words
    float largest;  // sensible value; none may be negative
    const char* meaning;
    const char* if_missing;
    MaterialMember member = {};
};

inline constexpr float any_number = std::numeric_limits<float>::max();

// clang-format off
inline constexpr MaterialKeyword material_keywords[] = {
    {"newmtl", 0, 0, "begins a material; its name follows", "an error"},
    {"Kd", 3, any_number, "diffuse albedo; with `Pm` 1, the colour of the metal", "black, or white with `map_Kd`",
     {.colour = &Material::diffuse_albedo, .is_albedo = true}},
    {"map_Kd", 0, 0, "texture that is multiplied with `Kd`, in sRGB", "no texture"},
    {"Ke", 3, any_number, "emitted radiance: a lamp, which shines from its front only", "0",
     {.colour = &Material::emission}},
    {"Ks", 3, any_number, "albedo of the Phong lobe, where the scene has `specular`", "0",
     {.colour = &Material::specular_albedo, .is_albedo = true, .feature = "FEATURE_SPECULAR"}},
    {"Ns", 1, any_number, "exponent of the Phong lobe", "1", {.number = &Material::specular_exponent, .default_number = 1}},
    {"d", 1, 1, "opacity: below 1 the material is glass", "1: opaque"},
    {"Tr", 1, 1, "1 minus the opacity", "0: opaque"},
    {"Ni", 1, any_number, "refractive index of the glass, or of the coat with `Pr`", "1 for glass, 1.5 for the coat"},
    {"Tf", 3, 1, "fraction of light that is left after one unit of length in glass, above 0", "1"},
    {"Kt", 3, 1, "the same as `Tf`", "1"},
    {"Pr", 1, 1, "roughness: microfacets, from chapter 11", "none"},
    {"Pm", 1, 1, "1 for metal, 0 for plastic, with `Pr`", "0"},
    {"Ka", 0, 0, "accepted without effect", "none"},
    {"illum", 0, 0, "accepted without effect", "none"},
};
// clang-format on

// The fraction of light that an opaque material without microfacets reflects, all lobes together.
inline vec3 albedo_of(const Material& material) {
    vec3 sum(0);
    for (const MaterialKeyword& keyword : material_keywords)
        if (keyword.member.is_albedo) sum += material.*keyword.member.colour;
    return sum;
}

}  // namespace lab
