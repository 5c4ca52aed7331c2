#include "scene/obj_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <unordered_map>

#include "error.h"
#include "scene/triangulate.h"

namespace lab {
namespace {

constexpr uint64_t max_obj_bytes = uint64_t{1} << 30;
constexpr size_t max_polygon_corners = 256;
constexpr size_t max_library_names = 256;

// A name behind usemtl, and how many faces use it.
struct UsedMaterial {
    std::string name;
    size_t line = 0;  // of its first usemtl; 0 for the faces before any
    size_t face_count = 0;
};

MtlMaterial grey_material() {
    Material material{};
    material.diffuse_albedo = vec3(0.5f);
    material.albedo_texture = -1;
    return {"", material, {}};
}

class ObjReader {
  public:
    ObjReader(const std::filesystem::path& path, const std::filesystem::path& materials, SourceFiles& files,
              std::vector<std::string>& warnings)
        : path_(path),
          materials_(materials),
          files_(files),
          warnings_(warnings),
          text_(files.read(path, max_obj_bytes)),
          statements_(path.string(), text_) {
        obj_.file = path.string();
    }

    ObjFile read() {
        if (!materials_.empty()) read_materials(materials_, materials_.parent_path());
        while (statements_.next()) {
            const std::string_view keyword = statements_.keyword();
            if (keyword == "v") add_position();
            if (keyword == "vn") obj_.normals.push_back(numbers(3));
            if (keyword == "vt") add_texture_coordinates();
            if (keyword == "f") add_face();
            if (keyword == "usemtl") use_material();
            if (keyword == "mtllib" && materials_.empty()) read_libraries();
        }
        if (obj_.corners.empty()) throw UserError(obj_.file + ": there are no faces in it");
        if (has_weights_ || has_colours_)
            warnings_.push_back(obj_.file + ": without effect here: " + (has_colours_ ? "colours" : "weights") + " of vertices");
        resolve_materials();
        return std::move(obj_);
    }

  private:
    // The first three numbers of the statement, of which `needed` must be there.
    vec3 numbers(size_t needed) const {
        const std::vector<std::string_view>& words = statements_.words();
        if (words.size() < needed)
            statements_.fail(std::string(statements_.keyword()) + " needs " + (needed == 1 ? "a number" : "3 numbers"));
        vec3 values(0);
        for (size_t i = 0; i < words.size(); ++i) {
            const std::optional<float> number = to_number(words[i]);
            if (!number) statements_.fail(in_quotes(words[i]) + " is not a finite number");
            if (i < 3) values[static_cast<int>(i)] = *number;
        }
        return values;
    }

    // Behind a position some programs write a weight, others red, green and blue.
    void add_position() {
        obj_.positions.push_back(numbers(3));
        const std::vector<std::string_view>& words = statements_.words();
        has_weights_ |= words.size() == 4 && to_number(words[3]) != 1.0f;
        has_colours_ |= words.size() > 5;
    }

    void add_texture_coordinates() {
        const vec2 coordinates(numbers(1));
        constexpr float limit = 8388608;  // 2^23
        if (std::max(std::abs(coordinates.x), std::abs(coordinates.y)) > limit)
            statements_.fail("texture coordinates beyond 2^23 are whole numbers in 32 bits and place nothing");
        obj_.texture_coordinates.push_back(coordinates);
    }

    // Removes an index and the slash behind it from a corner, and returns its place in an array of `count` elements. Indices
    // start at 1, negative ones count from the end, and 0 stands for none.
    uint32_t take_index(std::string_view& corner, size_t count, const char* what) const {
        const size_t length = std::min(corner.find('/'), corner.size());
        int index = 0;
        if (length > 0) {
            const auto [end, error] = std::from_chars(corner.data(), corner.data() + length, index);
            if (error == std::errc::result_out_of_range) statements_.fail("an index has more than 9 digits");
            if (end != corner.data() + length) statements_.fail("a face must be made of vertex indices");
        }
        corner.remove_prefix(std::min(length + 1, corner.size()));
        if (index == 0) return ObjCorner::none;
        const int64_t resolved = index > 0 ? int64_t{index} - 1 : static_cast<int64_t>(count) + index;
        if (resolved < 0 || resolved >= static_cast<int64_t>(count)) refuse_index(index, count, what);
        return static_cast<uint32_t>(resolved);
    }

    [[noreturn]] void refuse_index(int index, size_t count, const char* what) const {
        statements_.fail("the face refers to " + std::string(what) + " " + std::to_string(index) + ", but there are " +
                         std::to_string(count) + " so far (counted from 1)");
    }

    void add_face() {
        const std::vector<std::string_view>& words = statements_.words();
        if (words.size() < 3) statements_.fail("a face needs at least 3 corners");
        if (words.size() > max_polygon_corners) statements_.fail("a face may have at most 256 corners: triangulate it");
        face_.clear();
        for (std::string_view word : words) {
            ObjCorner& corner = face_.emplace_back();
            corner.position = take_index(word, obj_.positions.size(), "vertex");
            if (corner.position == ObjCorner::none) refuse_index(0, obj_.positions.size(), "vertex");
            corner.texture_coordinates = take_index(word, obj_.texture_coordinates.size(), "texture coordinate");
            corner.normal = take_index(word, obj_.normals.size(), "normal");
            if (!word.empty()) statements_.fail("a face must be made of vertex indices");
        }
        ++used_materials_[used_material_].face_count;
        if (face_.size() == 3) {
            add_triangle(0, 1, 2);
        } else {
            std::vector<vec3> polygon;
            for (const ObjCorner& corner : face_) polygon.push_back(obj_.positions[corner.position]);
            for (const auto& [a, b, c] : triangulate(polygon)) add_triangle(a, b, c);
        }
    }

    void add_triangle(uint32_t a, uint32_t b, uint32_t c) {
        if (obj_.triangle_materials.size() == max_triangle_count) statements_.fail("there are more than 2^28 - 1 triangles");
        const size_t capacity = obj_.corners.capacity();  // doubles when it is used up
        if (obj_.corners.size() == capacity && 2 * capacity * sizeof(ObjCorner) > memory_limit(text_.size()))
            statements_.fail("its triangles need far more memory than a file of its size should");
        obj_.corners.insert(obj_.corners.end(), {face_[a], face_[b], face_[c]});
        obj_.triangle_materials.push_back(used_material_);
        obj_.triangle_lines.push_back(static_cast<uint32_t>(statements_.line()));
    }

    // Exporters do not escape spaces, so all words together are tried before each of them. A folder may have the name of a word.
    void read_libraries() {
        std::error_code ignored;
        bool is_found = read_library(statements_.name());
        if (!is_found)
            for (const std::string_view name : statements_.words())
                if (!std::filesystem::is_directory(path_.parent_path() / to_path(name), ignored)) is_found |= read_library(name);
        if (!is_found) note_missing(statements_.line(), "there is no material file " + in_quotes(statements_.name()));
    }

    // Returns false if there is no such file.
    bool read_library(std::string_view name) {
        if (++library_names_ > max_library_names) statements_.fail("more than 256 names of material files");
        const std::filesystem::path folder = path_.parent_path(), file = folder / to_path(name);
        std::error_code ignored;  // a name that the file system refuses is not a file
        if (name.empty() || !std::filesystem::exists(file, ignored)) return false;
        if (!libraries_.insert(file.lexically_normal()).second) return true;  // already read
        read_materials(file, folder);
        return true;
    }

    void read_materials(const std::filesystem::path& file, const std::filesystem::path& texture_folder) {
        for (MtlMaterial& material : read_mtl(file, texture_folder, files_, warnings_)) {
            material_indices_.emplace(material.name, static_cast<uint32_t>(obj_.materials.size()));  // the first one counts
            obj_.materials.push_back(std::move(material));
        }
    }

    void use_material() {
        const auto [used, is_new] =
            used_indices_.try_emplace(std::string(statements_.name()), static_cast<uint32_t>(used_materials_.size()));
        if (is_new) used_materials_.push_back({used->first, statements_.line()});
        used_material_ = used->second;
    }

    // Models from elsewhere often lack their materials: they are rendered grey, and the first missing one is named.
    void note_missing(size_t line, const std::string& what) {
        if (missing_line_ > 0 && missing_line_ <= line) return;
        missing_line_ = line;
        missing_ = ":" + std::to_string(line) + ": " + what;
    }

    // At the end, since a material file may be named behind the faces that use it.
    void resolve_materials() {
        if (!materials_.empty() && obj_.materials.size() == 1) {
            obj_.triangle_materials.assign(obj_.triangle_materials.size(), 0);
            return;
        }
        std::vector<uint32_t> materials;
        size_t grey_face_count = 0;
        const auto grey = static_cast<uint32_t>(obj_.materials.size());
        for (const auto& [name, line, face_count] : used_materials_) {
            const auto material = material_indices_.find(name);
            const bool is_missing = material == material_indices_.end();
            materials.push_back(is_missing ? grey : material->second);
            if (!is_missing) continue;
            grey_face_count += face_count;
            if (line > 0) note_missing(line, name.empty() ? "usemtl needs a name" : "there is no material " + in_quotes(name));
        }
        for (uint32_t& material : obj_.triangle_materials) material = materials[material];
        if (grey_face_count > 0) {
            obj_.materials.push_back(grey_material());
            missing_ += ": " + std::to_string(grey_face_count) + " faces without a material are drawn in grey";
        }
        if (!missing_.empty()) warnings_.push_back(obj_.file + missing_);
    }

    const std::filesystem::path& path_;
    const std::filesystem::path& materials_;
    SourceFiles& files_;
    std::vector<std::string>& warnings_;
    const std::string text_;
    Statements statements_;
    ObjFile obj_;  // until the end, its triangles refer to used_materials_
    std::vector<ObjCorner> face_;
    std::unordered_map<std::string, uint32_t> material_indices_;
    std::vector<UsedMaterial> used_materials_ = {{}};
    std::unordered_map<std::string, uint32_t> used_indices_;
    uint32_t used_material_ = 0;                 // of the next face
    std::set<std::filesystem::path> libraries_;  // material files that were read
    size_t library_names_ = 0;                   // tried so far
    size_t missing_line_ = 0;
    std::string missing_;  // the first material or material file, with its line
    bool has_weights_ = false, has_colours_ = false;
};

}  // namespace

ObjFile read_obj(const std::filesystem::path& file, const std::filesystem::path& materials, SourceFiles& files,
                 std::vector<std::string>& warnings) {
    return ObjReader(file, materials, files, warnings).read();
}

}  // namespace lab
