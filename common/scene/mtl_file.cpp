#include "scene/mtl_file.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "error.h"
#include "scene/microfacets.h"

namespace lab {
namespace {

constexpr float default_coat_index = 1.5f;  // of plastic and lacquer

constexpr uint64_t max_mtl_bytes = uint64_t{16} << 20;

// How many numbers follow a keyword, and the largest sensible value; none may be negative.
struct Numbers {
    size_t count;
    float largest;
};
constexpr float any = std::numeric_limits<float>::max();
const std::map<std::string_view, Numbers> number_keywords = {
    {"Kd", {3, any}}, {"Ke", {3, any}}, {"Ks", {3, any}}, {"Tf", {3, 1}}, {"Kt", {3, 1}}, {"Ns", {1, any}},
    {"Ni", {1, any}}, {"d", {1, 1}},    {"Tr", {1, 1}},   {"Pr", {1, 1}}, {"Pm", {1, 1}},
};
const std::set<std::string_view> other_keywords = {"newmtl", "map_Kd", "Ka", "illum"};

// What tinyobjloader does not report: the whole name (its releases differ after a space), and which of these keywords a material
// has at all.
struct Stated {
    std::string name;
    bool diffuse = false;
    bool transmittance = false;
    bool refractive_index = false;
    bool roughness = false;
    bool metalness = false;
};

// Checks all numbers, since tinyobjloader reads missing or malformed ones as 0. Returns one element per material.
std::vector<Stated> check_lines(const std::string& file, std::string_view text, std::vector<std::string>& warnings) {
    std::vector<Stated> materials;
    std::set<std::string> ignored;
    for (size_t line_number = 1; !text.empty(); ++line_number) {
        const std::string_view line = take_line(text);
        const std::vector<std::string_view> words = words_of(line);
        if (words.empty()) continue;
        const auto fail = [&](const std::string& reason) { fail_at_line(file, line_number, reason); };
        const std::string keyword(words[0]);
        if (keyword == "newmtl") {
            if (name_in(line).empty()) fail("newmtl needs a name");
            // tinyobjloader would read it as a different keyword.
            if (line.substr(line.find("newmtl")).starts_with("newmtl#")) fail("newmtl needs a space after it");
            materials.emplace_back().name = name_in(line);
        } else if (materials.empty()) {
            fail("not a material file: it must start with newmtl");
        }
        if (keyword == "Kd") materials.back().diffuse = true;
        if (keyword == "Tf" || keyword == "Kt") materials.back().transmittance = true;
        if (keyword == "Ni") materials.back().refractive_index = true;
        if (keyword == "Pr") materials.back().roughness = true;
        if (keyword == "Pm") materials.back().metalness = true;
        if (keyword == "map_Kd" && words.size() > 1 && words[1].starts_with('-')) ignored.insert("options of map_Kd");

        if (const auto known = number_keywords.find(keyword); known != number_keywords.end()) {
            const auto [count, largest] = known->second;
            if (words.size() < count + 1)
                fail(keyword + " needs " + (count == 1 ? "a number" : std::to_string(count) + " numbers"));
            for (size_t i = 1; i <= count; ++i) {
                const std::optional<float> number = to_number(words[i]);
                if (!number || *number < 0 || *number > largest)
                    fail(keyword + " " + in_quotes(words[i]) +
                         (largest == any ? ": must be a finite number, at least 0" : ": must be a number in [0,1]"));
            }
        } else if (!other_keywords.contains(keyword)) {
            ignored.insert(in_quotes(keyword));
        }
    }
    if (materials.empty()) throw UserError(file + ": there is no material (newmtl) in it");
    if (!ignored.empty()) {
        std::string list;
        size_t count = 0;
        for (const std::string& name : ignored) {
            if (++count > 8) break;
            if (count > 1) list += ", ";
            list += name;
        }
        warnings.push_back(file + ": without effect here: " + list + (count > 8 ? ", ..." : ""));
    }
    return materials;
}

// A smooth dielectric with the index and transmittance that the file states.
void make_dielectric(const std::string& file, const tinyobj::material_t& source, const Stated& stated, Material& material) {
    const auto fail = [&](const std::string& reason) {
        throw UserError(file + ": material " + in_quotes(stated.name) + ": " + reason);
    };
    // Nothing transparent lies outside this range, and Fresnel's formulas would overflow.
    if (!(source.ior >= 0.01f && source.ior <= 100))
        fail("is transparent (d < 1) and needs a refractive index Ni from 0.01 to 100");
    material.refractive_index = source.ior;
    if (!stated.transmittance) return;
    for (int channel = 0; channel < 3; ++channel) {
        const float transmittance = source.transmittance[channel];
        if (!(transmittance > 0)) fail("Tf 0 absorbs everything at once: Tf must be in (0,1]");
        material.absorption[channel] = std::max(0.0f, -std::log(transmittance));
    }
}

vec3 to_vec3(const float (&values)[3]) { return {values[0], values[1], values[2]}; }

// Microfacets from Pr. Contradictions get a warning that says what takes effect.
Microfacets read_microfacets(const std::string& file, const tinyobj::material_t& source, const Stated& stated,
                             std::vector<std::string>& warnings) {
    const std::string subject = file + ": material " + in_quotes(stated.name) + ": ";
    const bool is_dielectric = source.dissolve < 1, is_metal = stated.metalness && source.metallic > 0;
    if (is_metal && !stated.roughness) warnings.push_back(subject + "Pm has no effect without Pr, the roughness");
    Microfacets microfacets{};
    if (!stated.roughness) return microfacets;
    if (is_dielectric) {
        if (is_metal) warnings.push_back(subject + "is transparent (d < 1), so that Pm has no effect");
        // At an index of 1 nothing bends, however rough.
        const bool is_smooth = source.roughness < smallest_roughness || source.ior == 1;
        microfacets.roughness = is_smooth ? 0 : source.roughness * source.roughness;
        return microfacets;
    }
    if (source.roughness < smallest_roughness)
        warnings.push_back(subject + "Pr below 0.01 makes a lobe that 32 bits cannot tell from a mirror's: it becomes 0.01");
    if (stated.transmittance && to_vec3(source.transmittance) != vec3(1))
        warnings.push_back(subject + "is opaque (d is 1), so that Tf has no effect");
    microfacets.coat_index = stated.refractive_index ? source.ior : default_coat_index;
    if (!(microfacets.coat_index >= 1 && microfacets.coat_index <= 100))
        throw UserError(subject + "has a coat (Pr) and needs a refractive index Ni from 1 to 100");
    const float roughness = std::max(source.roughness, smallest_roughness);
    microfacets.roughness = roughness * roughness;
    if (stated.metalness) microfacets.metalness = source.metallic;
    return microfacets;
}

}  // namespace

std::vector<MtlMaterial> read_mtl(const std::filesystem::path& file, const std::filesystem::path& texture_folder,
                                  SourceFiles& files, std::vector<std::string>& warnings) {
    const std::string name = file.string();
    const std::string text = clean_text(files.read(file, max_mtl_bytes));
    if (text.find('\0') != std::string::npos) throw UserError(name + ": not a material file: it is binary");
    const std::vector<Stated> stated = check_lines(name, text, warnings);

    std::map<std::string, int> indices;
    std::vector<tinyobj::material_t> sources;
    std::istringstream stream(text);
    tinyobj::LoadMtl(&indices, &sources, &stream, nullptr, nullptr);

    std::vector<MtlMaterial> materials;
    for (size_t i = 0; i < stated.size(); ++i) {
        const tinyobj::material_t& source = sources.at(i);
        Material material = {
            .diffuse_albedo = to_vec3(source.diffuse),
            .albedo_texture = -1,
            .emission = to_vec3(source.emission),
            .specular_exponent = source.shininess,
            .specular_albedo = to_vec3(source.specular),
            .refractive_index = 0,
            .absorption = vec3(0),
            .light_density = 0,
        };
        std::filesystem::path texture;
        if (!source.diffuse_texname.empty()) {
            std::string relative = source.diffuse_texname;
            std::replace(relative.begin(), relative.end(), '\\', '/');  // as on Windows
            texture = texture_folder / relative;
            if (!stated[i].diffuse) material.diffuse_albedo = vec3(1);
        }
        if (source.dissolve < 1) make_dielectric(name, source, stated[i], material);
        const Microfacets microfacets = read_microfacets(name, source, stated[i], warnings);
        if (stated[i].roughness) material.specular_albedo = vec3(0);  // microfacets replace the Phong lobe
        materials.push_back({stated[i].name, material, texture, microfacets});
    }
    return materials;
}

}  // namespace lab
