#include "scene/mtl_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "error.h"
#include "scene/material_keywords.h"
#include "scene/microfacets.h"

namespace lab {
namespace {

constexpr float default_coat_index = 1.5f;  // of plastic and lacquer

constexpr uint64_t max_mtl_bytes = uint64_t{16} << 20;

// Options of a texture, and how many words may follow them. All but the first of these are numbers that may be left out.
const std::map<std::string_view, size_t> texture_options = {
    {"-blendu", 1},     {"-blendv", 1}, {"-clamp", 1}, {"-cc", 1}, {"-type", 1}, {"-imfchan", 1}, {"-texres", 1},
    {"-colorspace", 1}, {"-bm", 1},     {"-boost", 1}, {"-mm", 2}, {"-o", 3},    {"-s", 3},       {"-t", 3},
};

constexpr const char* transparent = "is transparent (d < 1 or Tr > 0)";

// A material's statements.
struct Stated {
    std::string name;
    std::map<std::string_view, vec3> numbers;  // by keyword, with Tf for Kt; the last statement of a keyword counts
    std::string texture;                       // empty without map_Kd

    bool has(std::string_view keyword) const { return numbers.contains(keyword); }
    vec3 vector(std::string_view keyword, vec3 absent) const { return has(keyword) ? numbers.at(keyword) : absent; }
    float number(std::string_view keyword, float absent) const { return vector(keyword, vec3(absent)).x; }
    float opacity() const { return has("d") ? number("d", 1) : 1 - number("Tr", 0); }
};

// Reads a statement with numbers.
void read_numbers(const Statements& statement, const MaterialKeyword& allowed, Stated& material, std::set<std::string>& ignored) {
    const std::string_view keyword = allowed.name;
    const std::string name(keyword);
    const auto count = static_cast<size_t>(allowed.count);
    std::vector<std::string_view> words = statement.words();
    if (keyword == "d" && !words.empty() && words[0] == "-halo") {
        ignored.insert("-halo");
        words.erase(words.begin());
    }
    if (words.size() == 1) words.resize(count, words[0]);
    if (words.size() < count) statement.fail(name + " needs " + (count == 1 ? "a number" : std::to_string(count) + " numbers"));
    vec3& values = material.numbers[keyword == "Kt" ? "Tf" : keyword];
    for (size_t i = 0; i < count; ++i) {
        const std::optional<float> number = to_number(words[i]);
        if (!number || *number < 0 || *number > allowed.largest)
            statement.fail(
                name + " " + in_quotes(words[i]) +
                (allowed.largest == any_number ? ": must be a finite number, at least 0" : ": must be a number in [0,1]"));
        values[static_cast<int>(i)] = *number;
    }
}

// Reads the name behind map_Kd. Options may stand before and behind it; they are ignored.
void read_texture_name(const Statements& statement, Stated& material, std::set<std::string>& ignored) {
    const std::vector<std::string_view>& words = statement.words();
    std::string_view name;
    for (size_t i = 0; i < words.size(); ++i) {
        const auto option = texture_options.find(words[i]);
        if (option == texture_options.end()) {
            // The name goes on, with the blanks in it.
            const char* const start = name.empty() ? words[i].data() : name.data();
            name = std::string_view(start, static_cast<size_t>(words[i].data() + words[i].size() - start));
            continue;
        }
        ignored.insert("options of map_Kd");
        const size_t last = i + option->second;
        for (++i; i < last && i + 1 < words.size() && to_number(words[i + 1]);) ++i;
    }
    if (name.empty()) ignored.insert("map_Kd without a name");
    material.texture = to_path(name);
}

std::vector<Stated> read_statements(Statements statements, const std::string& file, std::vector<std::string>& warnings) {
    std::vector<Stated> materials;
    std::set<std::string> ignored;
    while (statements.next()) {
        const std::string_view keyword = statements.keyword();
        if (keyword == "newmtl") {
            if (statements.name().empty()) statements.fail("newmtl needs a name");
            materials.emplace_back().name = statements.name();
        } else if (materials.empty()) {
            statements.fail("not a material file: it must start with newmtl");
        }
        const auto known = std::ranges::find(material_keywords, keyword, &MaterialKeyword::name);
        if (known == std::end(material_keywords))
            ignored.insert(in_quotes(keyword));
        else if (known->count > 0)
            read_numbers(statements, *known, materials.back(), ignored);
        else if (keyword == "map_Kd")
            read_texture_name(statements, materials.back(), ignored);
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

// A smooth dielectric with the index and transmittance that the file states. `subject` starts messages.
void make_dielectric(const std::string& subject, const Stated& stated, Material& material, std::vector<std::string>& warnings) {
    material.refractive_index = stated.number("Ni", 1);
    // Nothing transparent lies outside this range, and Fresnel's formulas would overflow.
    if (!(material.refractive_index >= 0.01f && material.refractive_index <= 100))
        throw UserError(subject + transparent + " and needs a refractive index Ni from 0.01 to 100");
    const vec3 transmittance = stated.vector("Tf", vec3(1));
    for (int channel = 0; channel < 3; ++channel) {
        if (!(transmittance[channel] > 0)) throw UserError(subject + "Tf 0 absorbs everything at once: Tf must be in (0,1]");
        material.absorption[channel] = std::max(0.0f, -std::log(transmittance[channel]));
    }
    if (material.refractive_index == 1 && material.absorption == vec3(0))
        warnings.push_back(subject + transparent + ", and with Ni 1 it is invisible: state Ni, or d 1 if it is opaque");
}

// Microfacets from Pr. Contradictions get a warning that says what takes effect.
Microfacets read_microfacets(const std::string& subject, const Stated& stated, std::vector<std::string>& warnings) {
    const float metalness = stated.number("Pm", 0), stated_roughness = stated.number("Pr", 0);
    Microfacets microfacets{};
    if (!stated.has("Pr")) {
        if (metalness > 0) warnings.push_back(subject + "Pm has no effect without Pr, the roughness");
        return microfacets;
    }
    if (stated.opacity() < 1) {
        if (metalness > 0) warnings.push_back(subject + transparent + ", so that Pm has no effect");
        // At an index of 1 nothing bends, however rough.
        const bool is_smooth = stated_roughness < smallest_roughness || stated.number("Ni", 1) == 1;
        microfacets.roughness = is_smooth ? 0 : stated_roughness * stated_roughness;
        return microfacets;
    }
    if (stated_roughness < smallest_roughness)
        warnings.push_back(subject + "Pr below 0.01 makes a lobe that 32 bits cannot tell from a mirror's: it becomes 0.01");
    if (stated.vector("Tf", vec3(1)) != vec3(1)) warnings.push_back(subject + "is opaque (d is 1), so that Tf has no effect");
    // A metal has no coat, and may have any index: that of gold is below 1.
    microfacets.coat_index = metalness == 1 ? default_coat_index : stated.number("Ni", default_coat_index);
    if (!(microfacets.coat_index >= 1 && microfacets.coat_index <= 100))
        throw UserError(subject + "has a coat (Pr) and needs a refractive index Ni from 1 to 100");
    const float roughness = std::max(stated_roughness, smallest_roughness);
    microfacets.roughness = roughness * roughness;
    microfacets.metalness = metalness;
    return microfacets;
}

MtlMaterial make_material(const std::string& file, const Stated& stated, const std::filesystem::path& texture_folder,
                          std::vector<std::string>& warnings) {
    const std::string subject = file + ": material " + in_quotes(stated.name) + ": ";
    const bool has_texture = !stated.texture.empty(), is_opaque = !(stated.opacity() < 1);
    Material material{};
    material.albedo_texture = -1;
    for (const MaterialKeyword& keyword : material_keywords) {
        const MaterialMember& member = keyword.member;
        if (member.colour) material.*member.colour = stated.vector(keyword.name, vec3(0));
        if (member.number) material.*member.number = stated.number(keyword.name, member.default_number);
    }
    if (has_texture && !stated.has("Kd")) material.diffuse_albedo = vec3(1);
    if (!is_opaque) make_dielectric(subject, stated, material, warnings);
    if (is_opaque && has_texture && material.diffuse_albedo == vec3(0))
        warnings.push_back(subject + "Kd 0 makes map_Kd black, as they are multiplied: set Kd 1 1 1 to see the texture");
    const Microfacets microfacets = read_microfacets(subject, stated, warnings);
    for (const MaterialKeyword& keyword : material_keywords)  // microfacets replace lobes
        if (keyword.member.feature && stated.has("Pr")) material.*keyword.member.colour = vec3(0);
    return {stated.name, material, has_texture ? texture_folder / stated.texture : "", microfacets};
}

}  // namespace

std::vector<MtlMaterial> read_mtl(const std::filesystem::path& file, const std::filesystem::path& texture_folder,
                                  SourceFiles& files, std::vector<std::string>& warnings) {
    const std::string name = file.string(), text = files.read(file, max_mtl_bytes);
    std::vector<MtlMaterial> materials;
    for (const Stated& stated : read_statements(Statements(name, text), name, warnings))
        materials.push_back(make_material(name, stated, texture_folder, warnings));
    return materials;
}

}  // namespace lab
