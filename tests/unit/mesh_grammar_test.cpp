// Random valid OBJ and MTL files with every construct, read by the loader. tinyobjloader reads the same meshes without what it
// misreads: marks, NULs, joined lines, comments behind statements, slashes behind the last index, quotes and several libraries.
#define TINYOBJLOADER_IMPLEMENTATION
#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

#include <cmath>
#include <cstdlib>
#include <map>
#include <regex>

#include "mesh_fixture.h"
#include "scene/microfacets.h"
#include "scene/obj_file.h"

namespace lab {
namespace {

using Words = std::vector<std::string>;

// ---------------------------------------------------------------------------------------------- the second reader
// tinyobjloader does not tell which statements a material has.
struct SecondMaterial {
    std::map<std::string, std::vector<float>> numbers;
    std::string texture;

    float number(const char* keyword, float absent) const { return numbers.contains(keyword) ? numbers.at(keyword)[0] : absent; }
    vec3 vector(const char* keyword, float absent) const {
        if (!numbers.contains(keyword)) return vec3(absent);
        const std::vector<float>& values = numbers.at(keyword);
        return {values[0], values[1], values[2]};
    }
};

// Reads statements of a keyword, a blank and the rest. The first material of a name counts.
std::map<std::string, SecondMaterial> second_materials(const std::string& mtl) {
    std::map<std::string, SecondMaterial> materials;
    SecondMaterial ignored, *material = nullptr;
    std::istringstream lines(mtl);
    for (std::string keyword, rest; lines >> keyword && std::getline(lines >> std::ws, rest);) {
        if (keyword == "newmtl") {
            const auto [place, is_new] = materials.try_emplace(rest);
            material = is_new ? &place->second : &ignored;
        } else if (keyword == "map_Kd") {
            material->texture = rest;
        } else {
            std::istringstream words(rest);
            std::vector<float>& numbers = material->numbers[keyword == "Kt" ? "Tf" : keyword];
            numbers.clear();
            for (std::string word; words >> word;) numbers.push_back(static_cast<float>(std::strtod(word.c_str(), nullptr)));
        }
    }
    return materials;
}

struct SecondMesh {
    std::vector<double> positions, normals, texture_coordinates;
    std::vector<ObjCorner> corners;
    std::vector<std::string> triangle_materials;
};

SecondMesh second_mesh(const std::string& obj, const std::string& mtl) {
    tinyobj::attrib_t arrays;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warnings, errors;
    std::istringstream text("mtllib both.mtl\n" + obj), libraries(mtl);
    tinyobj::MaterialStreamReader library(libraries);
    EXPECT_TRUE(tinyobj::LoadObj(&arrays, &shapes, &materials, &warnings, &errors, &text, &library, false)) << errors;
    SecondMesh mesh{arrays.vertices, arrays.normals, arrays.texcoords, {}, {}};
    for (const tinyobj::shape_t& shape : shapes) {
        const tinyobj::index_t* face = shape.mesh.indices.data();
        const auto corner = [&](size_t i) {  // -1 stands for none, here too
            return ObjCorner{static_cast<uint32_t>(face[i].vertex_index), static_cast<uint32_t>(face[i].texcoord_index),
                             static_cast<uint32_t>(face[i].normal_index)};
        };
        for (size_t f = 0; f < shape.mesh.num_face_vertices.size(); face += shape.mesh.num_face_vertices[f++])
            for (size_t i = 2; i < shape.mesh.num_face_vertices[f]; ++i) {
                mesh.corners.insert(mesh.corners.end(), {corner(0), corner(i - 1), corner(i)});
                const int material = shape.mesh.material_ids[f];
                mesh.triangle_materials.push_back(material < 0 ? "" : materials.at(static_cast<size_t>(material)).name);
            }
    }
    return mesh;
}

// Its doubles have errors in their last bits.
template <typename Vector>
void expect_equal(const std::vector<Vector>& read, const std::vector<double>& second) {
    ASSERT_EQ(read.size() * sizeof(Vector) / sizeof(float), second.size());
    for (size_t i = 0; i < second.size(); ++i)
        EXPECT_FLOAT_EQ(reinterpret_cast<const float*>(read.data())[i], static_cast<float>(second[i]));
}

void expect_equal(const MtlMaterial& read, const SecondMaterial& second, const std::filesystem::path& folder) {
    const bool has_texture = !second.texture.empty(), is_rough = second.numbers.contains("Pr");
    EXPECT_EQ(read.material.diffuse_albedo, second.vector("Kd", has_texture ? 1 : 0));
    EXPECT_EQ(read.material.emission, second.vector("Ke", 0));
    EXPECT_EQ(read.material.specular_albedo, is_rough ? vec3(0) : second.vector("Ks", 0));
    EXPECT_EQ(read.material.specular_exponent, second.number("Ns", 1));
    EXPECT_EQ(read.albedo_texture, has_texture ? folder / second.texture : "");

    const float opacity = second.number("d", 1 - second.number("Tr", 0)), index = second.number("Ni", 1);
    const bool is_glass = opacity < 1;
    EXPECT_EQ(read.material.refractive_index, is_glass ? index : 0);
    for (int i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(read.material.absorption[i], is_glass ? -std::log(second.vector("Tf", 1)[i]) : 0);

    const float roughness = second.number("Pr", 0), least = is_glass ? 0 : 0.01f;
    const bool is_smooth = !is_rough || (is_glass && (roughness < smallest_roughness || index == 1));
    const float used = std::max(roughness, least), metalness = second.number("Pm", 0);
    EXPECT_FLOAT_EQ(read.microfacets.roughness, is_smooth ? 0 : used * used);
    EXPECT_EQ(read.microfacets.metalness, is_smooth || is_glass ? 0 : metalness);
    if (is_rough && !is_glass && metalness < 1) {
        EXPECT_EQ(read.microfacets.coat_index, second.number("Ni", 1.5f));
    }
}

// ---------------------------------------------------------------------------------------------- the writer of files
std::string without_blanks(std::string name) {
    std::ranges::replace(name, ' ', '_');
    return name;
}

class Writer {
  public:
    explicit Writer(uint32_t seed) : random_(seed) {}

    uint32_t below(size_t bound) { return static_cast<uint32_t>(std::uniform_int_distribution<size_t>(0, bound - 1)(random_)); }
    bool chance(int percent) { return below(100) < static_cast<uint32_t>(percent); }
    std::string one_of(const Words& words) { return words[below(words.size())]; }

    // A number in [low, high], in one of its spellings.
    std::string number(double low, double high) {
        if (low <= 0 && high >= 0 && chance(10)) return one_of({"0", "-0", "+0.0", "0e5", "1e-400", "1e-42", ".0", "0."});
        char text[40];
        const char* const format = one_format({"%.9g", "%+.7e", "%.4f", "%.17g", "%E"});
        std::snprintf(text, sizeof text, format, std::uniform_real_distribution<double>(low, high)(random_));
        return std::regex_replace(text, std::regex(chance(30) ? "^0\\." : "^$"), ".");
    }

    std::string numbers(int count, double low, double high) {
        std::string text;
        for (int i = 0; i < count; ++i) text += (i == 0 ? "" : " ") + number(low, high);
        return text;
    }

    // Adds a statement, with everything around it that has no meaning. Blanks in names must stay as they are.
    void add(const std::string& statement, bool is_name = false, const std::string& plain = "") {
        plain_ += (plain.empty() ? statement : plain) + "\n";
        std::string text;
        for (const char c : statement)
            text += c != ' ' || is_name ? std::string(1, c)
                    : chance(6)         ? " \\" + one_of({"", " ", "# not joined"}) + end()
                                        : blank();
        const std::string comments = is_name ? " # x|\t# a \\|" : " # x|#x|\t#|# a \\| ## 1.#IND|";
        if (chance(30)) text += comment(comments);
        if (chance(30)) text = blank() + text;
        if (chance(30)) text += blank();
        text_ += text + end();
        if (chance(20)) text_ += one_of({"", "# comment", "\t#v 1 2 3", "# v 1 2 \\", " "}) + end();
    }

    // Adds a name, which tinyobjloader would read up to its first blank.
    void add_name(const std::string& keyword, const std::string& name) {
        add(keyword + " " + quoted(name), true, keyword + " " + without_blanks(name));
    }

    std::string quoted(const std::string& name) { return chance(20) ? '"' + name + '"' : name; }

    // What was added, as tinyobjloader reads it right.
    std::string take_plain() { return std::exchange(plain_, ""); }

    std::string take() {
        std::string text = chance(30) ? "\xef\xbb\xbf" + text_ : text_;
        if (chance(30)) text.resize(text.find_last_not_of("\r\n") + 1);
        if (chance(30)) text.append(1 + below(5), '\0');
        text_.clear();
        line_end_ = one_of({"\n", "\r\n", "\r"});
        return text;
    }

  private:
    std::string blank() { return one_of({" ", " ", " ", "  ", "\t", " \t"}); }
    std::string end() { return line_end_; }
    const char* one_format(const std::vector<const char*>& formats) { return formats[below(formats.size())]; }
    std::string comment(const std::string& choices) {
        const std::regex bar("\\|");
        return one_of(Words(std::sregex_token_iterator(choices.begin(), choices.end(), bar, -1), {}));
    }

    std::mt19937 random_;
    std::string text_, plain_, line_end_ = "\n";
};

const Words material_names = {"red", "light grey", "Material #25", "a/b", "red.001", "\u00e9", "x#y"};

std::string material_file(Writer& writer) {
    const auto maybe = [&](const std::string& statement) {
        if (writer.chance(50)) writer.add(statement);
    };
    for (uint32_t count = 1 + writer.below(4); count > 0; --count) {
        writer.add_name("newmtl", writer.one_of(material_names));
        for (const char* keyword : {"Kd ", "Ke ", "Ks ", "Ka "}) maybe(keyword + writer.numbers(3, 0, 1));
        maybe(writer.one_of({"Tf ", "Kt "}) + writer.numbers(3, 0.1, 1));
        maybe("Ns " + writer.number(0, 900));
        maybe("Ni " + writer.number(1, 3));
        maybe(writer.one_of({"d ", "Tr "}) + writer.one_of({writer.number(0, 1), "1", "1.0"}));
        maybe(writer.one_of({"Pr ", "Pm "}) + writer.number(0, 1));
        maybe(writer.one_of({"Pr ", "Pm "}) + writer.one_of({"0", "1", "0.005"}));
        maybe("illum 2");
        maybe("sharpness 60");
        if (writer.chance(50)) {
            std::string options;
            while (writer.chance(40))
                options +=
                    writer.one_of({"-s " + writer.numbers(1, 1, 9), "-o " + writer.numbers(2, -1, 1), "-cc on", "-clamp off",
                                   "-t " + writer.numbers(3, 0, 1), "-mm " + writer.numbers(2, 0, 1), "-mm 0", "-bm 0.5",
                                   "-imfchan r", "-blendu off", "-texres 9", "-type sphere", "-colorspace sRGB"}) +
                    " ";
            const std::string name = writer.one_of({"a.png", "a b.png", "t\\a.png", "2.png", "a#1.png"});
            writer.add("map_Kd " + options + writer.quoted(name), true,
                       "map_Kd " + std::regex_replace(name, std::regex("\\\\"), "/"));
        }
    }
    return writer.take();
}

class Mesh {
  public:
    explicit Mesh(Writer& writer) : writer_(writer) {}

    std::string text(const Words& libraries) {
        add_libraries(libraries);
        for (int i = 0; i < 12; ++i) {
            if (writer_.chance(40)) writer_.add_name("usemtl", writer_.one_of(material_names));
            if (writer_.chance(10)) writer_.add("usemtl", true);
            if (writer_.chance(30)) writer_.add(writer_.one_of({"g", "g a b", "o x#y", "g \"a", "o C:/a"}), true);
            if (writer_.chance(30)) writer_.add(writer_.one_of({"s off", "l 1 2", "p 1", "vp 0.5", "unknown 1 2"}));
            add_polygon();
        }
        if (libraries_are_missing_) add_libraries(libraries);
        return writer_.take();
    }

  private:
    void add_libraries(const Words& libraries) {
        libraries_are_missing_ = !libraries_are_missing_ && writer_.chance(30);
        if (libraries_are_missing_) return;
        const bool share_a_line = writer_.chance(50);
        std::string line;
        for (const std::string& name : libraries) {
            line += " " + writer_.one_of({name, '"' + name + '"', ".\\" + name, "./" + name});
            if (!share_a_line || name == libraries.back()) writer_.add("mtllib" + line, true), line.clear();
        }
    }

    // A convex polygon of new vertices.
    void add_polygon() {
        const uint32_t corners = 3 + writer_.below(6);
        const double x = writer_.below(100), y = writer_.below(100);
        for (uint32_t i = 0; i < corners; ++i, ++positions_) {
            const double angle = 2 * std::acos(-1) * i / corners;
            writer_.add("v " + std::to_string(x + std::cos(angle)) + " " + std::to_string(y + std::sin(angle)) + " " +
                        writer_.number(-0.001, 0.001) + writer_.one_of({"", "", " 1", " 1 0.5 0"}));
        }
        for (; writer_.chance(70) || normals_ == 0; ++normals_) writer_.add("vn " + writer_.numbers(3, -2, 2));
        for (; writer_.chance(70) || coordinates_ == 0; ++coordinates_)
            writer_.add("vt " + writer_.numbers(1 + static_cast<int>(writer_.below(3)), -9, 9));
        std::string face = "f";
        for (uint32_t i = 0; i < corners; ++i) {
            const std::string normal = index(writer_.below(normals_), normals_),
                              coordinates = index(writer_.below(coordinates_), coordinates_);
            face += " " + index(positions_ - corners + i, positions_) +
                    writer_.one_of({"", "/", "//", "/" + coordinates, "/" + coordinates + "/", "//" + normal,
                                    "/" + coordinates + "/" + normal});
        }
        writer_.add(face, false, std::regex_replace(face, std::regex("/+(?= |$)"), ""));
    }

    std::string index(uint32_t place, uint32_t count) {
        const bool from_the_end = writer_.chance(30);
        return from_the_end ? "-" + std::to_string(count - place) : std::to_string(place + 1);
    }

    Writer& writer_;
    uint32_t positions_ = 0, normals_ = 0, coordinates_ = 0;
    bool libraries_are_missing_ = false;
};

TEST(MeshGrammar, IsReadAlikeByASecondReader_all) {
    const TestFolder folder;
    for (uint32_t seed = 0; seed < 1000; ++seed) {
        SCOPED_TRACE("seed " + std::to_string(seed));
        Writer writer(seed);
        folder.write("a.mtl", material_file(writer));
        folder.write("b.mtl", material_file(writer));
        const std::string mtl = writer.take_plain();
        const std::filesystem::path file = folder.write("a.obj", Mesh(writer).text({"a.mtl", "b.mtl"}));

        SourceFiles sources;
        std::vector<std::string> warnings;
        const ObjFile read = read_obj(file, {}, sources, warnings);
        const SecondMesh second = second_mesh(writer.take_plain(), mtl);
        const std::map<std::string, SecondMaterial> materials = second_materials(mtl);
        expect_equal(read.positions, second.positions);
        expect_equal(read.normals, second.normals);
        expect_equal(read.texture_coordinates, second.texture_coordinates);
        EXPECT_EQ(read.corners, second.corners);
        ASSERT_EQ(read.triangle_materials.size(), second.triangle_materials.size());
        for (size_t i = 0; i < second.triangle_materials.size(); ++i) {
            const MtlMaterial& material = read.materials.at(read.triangle_materials[i]);
            const auto known = materials.find(second.triangle_materials[i]);
            const bool is_grey = known == materials.end();
            EXPECT_EQ(without_blanks(material.name), is_grey ? "" : known->first);
            if (is_grey)
                EXPECT_EQ(material.material.diffuse_albedo, vec3(0.5f));
            else
                expect_equal(material, known->second, folder.path());
        }
        if (HasFailure())
            FAIL() << file_bytes(file) << "\na.mtl:\n"
                   << file_bytes(folder / "a.mtl") << "\nb.mtl:\n"
                   << file_bytes(folder / "b.mtl");
    }
}

}  // namespace
}  // namespace lab
