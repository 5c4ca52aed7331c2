#include "scene/obj_file.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <streambuf>
#include <unordered_map>

#include "error.h"
#include "scene/text_lines.h"
#include "scene/triangulate.h"

namespace lab {
namespace {

constexpr uint64_t max_obj_bytes = uint64_t{1} << 30;
constexpr int max_polygon_corners = 256;
constexpr size_t max_library_names = 256;

// Lets tinyobjloader read from memory, and knows which line it read last.
class TextBuffer : public std::streambuf {
  public:
    explicit TextBuffer(std::string& text) {
        setg(text.data(), text.data(), text.data() + text.size());
        counted_end_ = eback();
    }

    std::string_view last_line() const {
        std::string_view line(eback(), static_cast<size_t>(gptr() - eback()));
        if (line.ends_with('\n')) line.remove_suffix(1);
        if (line.ends_with('\r')) line.remove_suffix(1);
        const size_t end_before = line.find_last_of("\r\n");
        return end_before == std::string_view::npos ? line : line.substr(end_before + 1);
    }

    // Counts on from the previous call.
    size_t last_line_number() const {
        std::string_view text(counted_end_, static_cast<size_t>(gptr() - counted_end_));
        for (; !text.empty(); ++counted_lines_) take_line(text);
        counted_end_ = gptr();
        return counted_lines_;
    }

  private:
    mutable const char* counted_end_;
    mutable size_t counted_lines_ = 0;
};

// Collects what tinyobjloader's callbacks report.
class ObjReader : public tinyobj::MaterialReader {
  public:
    ObjReader(const std::filesystem::path& path, SourceFiles& files, std::vector<std::string>& warnings)
        : path_(path), files_(files), warnings_(warnings), text_(clean_text(files.read(path, max_obj_bytes))), buffer_(text_) {
        obj_.file = path.string();
    }

    ObjFile read() {
        if (text_.find('\0') != std::string::npos) throw UserError(obj_.file + ": not an .obj file: it is binary");
        check_faces_without_corners();
        tinyobj::callback_t callbacks;
        callbacks.vertex_cb = [](void* self, float x, float y, float z, float) {
            static_cast<ObjReader*>(self)->check_numbers(3);
            static_cast<ObjReader*>(self)->obj_.positions.emplace_back(x, y, z);
        };
        callbacks.normal_cb = [](void* self, float x, float y, float z) {
            static_cast<ObjReader*>(self)->check_numbers(3);
            static_cast<ObjReader*>(self)->obj_.normals.emplace_back(x, y, z);
        };
        callbacks.texcoord_cb = [](void* self, float u, float v, float) {
            static_cast<ObjReader*>(self)->check_numbers(1);
            static_cast<ObjReader*>(self)->check_texture_coordinate(u, v);
            static_cast<ObjReader*>(self)->obj_.texture_coordinates.emplace_back(u, v);
        };
        callbacks.index_cb = [](void* self, tinyobj::index_t* indices, int count) {
            static_cast<ObjReader*>(self)->add_face({indices, static_cast<size_t>(count)});
        };
        callbacks.usemtl_cb = [](void* self, const char*, int) { static_cast<ObjReader*>(self)->use_material(); };
        std::istream stream(&buffer_);
        tinyobj::LoadObjWithCallback(stream, callbacks, this, this);

        if (obj_.corners.empty()) throw UserError(obj_.file + ": there are no faces in it");
        if (faces_without_material_ > 0)
            missing_ += ": " + std::to_string(faces_without_material_) + " faces without a material are drawn in grey";
        if (!missing_.empty()) warnings_.push_back((missing_.starts_with(':') ? obj_.file : "") + missing_);
        return std::move(obj_);
    }

    // Called for a word after mtllib. Exporters do not escape spaces, so all words together are tried first, and then each one
    // until one of them is a file.
    bool operator()(const std::string&, std::vector<tinyobj::material_t>*, std::map<std::string, int>*, std::string*,
                    std::string*) override {
        std::string all(name_in(buffer_.last_line()));
        std::erase(all, '\\');  // escapes a space
        const std::filesystem::path folder = path_.parent_path();
        std::vector<std::string_view> names = words_of(buffer_.last_line());
        names[0] = all;
        for (const std::string_view name : names) {
            if (++library_names_ > max_library_names) fail("more than 256 names of material files");
            std::error_code ignored;  // a name that the file system refuses is not a file
            if (!std::filesystem::exists(folder / name, ignored)) continue;
            read_library(folder / name);
            return true;
        }
        note_missing("there is no material file " + in_quotes(all));
        return true;
    }

  private:
    [[noreturn]] void fail(const std::string& reason) const { fail_at_line(obj_.file, buffer_.last_line_number(), reason); }

    // tinyobjloader reads anything but a finite number as 0.
    void check_numbers(size_t count) const {
        const std::vector<std::string_view> words = words_of(buffer_.last_line());
        if (words.size() < count + 1) fail(std::string(words[0]) + " needs " + std::to_string(count) + " numbers");
        for (size_t i = 1; i < words.size(); ++i)
            if (!to_number(words[i])) fail(in_quotes(words[i]) + " is not a finite number");
    }

    void check_texture_coordinate(float u, float v) const {
        constexpr float limit = 8388608;  // 2^23
        if (std::max(std::abs(u), std::abs(v)) > limit)
            fail("texture coordinates beyond 2^23 are whole numbers in 32 bits and place nothing");
    }

    // tinyobjloader reads a missing number as 0, and wraps those of more than 32 bits.
    void check_indices() const {
        std::string_view line = buffer_.last_line();
        line.remove_prefix(line.find('f') + 1);
        size_t digits = 0;
        for (const char c : line) {
            digits = c >= '0' && c <= '9' ? digits + 1 : 0;
            if (digits > 9) fail("an index has more than 9 digits");
            if (digits == 0 && c != '-' && c != '/' && c != ' ' && c != '\t') fail("a face must be made of vertex indices");
        }
    }

    // Indices start at 1, negative ones count from the end; tinyobjloader reports 0 for absent ones.
    uint32_t resolve(int index, size_t count, const char* what) const {
        const int64_t resolved = index > 0 ? int64_t{index} - 1 : static_cast<int64_t>(count) + index;
        if (index == 0 || resolved < 0 || resolved >= static_cast<int64_t>(count))
            fail("the face refers to " + std::string(what) + " " + std::to_string(index) + ", but there are " +
                 std::to_string(count) + " so far (counted from 1)");
        return static_cast<uint32_t>(resolved);
    }

    void add_face(std::span<const tinyobj::index_t> indices) {
        check_indices();
        if (indices.size() < 3) fail("a face needs at least 3 corners");
        if (indices.size() > max_polygon_corners) fail("a face may have at most 256 corners: triangulate it");
        face_.clear();
        for (const tinyobj::index_t& index : indices) {
            ObjCorner& corner = face_.emplace_back();
            corner.position = resolve(index.vertex_index, obj_.positions.size(), "vertex");
            if (index.texcoord_index != 0)
                corner.texture_coordinates = resolve(index.texcoord_index, obj_.texture_coordinates.size(), "texture coordinate");
            if (index.normal_index != 0) corner.normal = resolve(index.normal_index, obj_.normals.size(), "normal");
        }
        if (!material_) {
            material_ = static_cast<uint32_t>(obj_.materials.size());
            obj_.materials.push_back(grey_material());
            grey_ = material_;
        }
        if (material_ == grey_) ++faces_without_material_;
        if (face_.size() == 3) {
            add_triangle(0, 1, 2);
        } else {
            std::vector<vec3> polygon;
            for (const ObjCorner& corner : face_) polygon.push_back(obj_.positions[corner.position]);
            for (const auto& [a, b, c] : triangulate(polygon)) add_triangle(a, b, c);
        }
    }

    // tinyobjloader skips them silently.
    void check_faces_without_corners() const {
        for (size_t end = text_.find("\nf"); end != std::string::npos; end = text_.find("\nf", end + 1)) {
            const size_t next = end + 2;
            if (next == text_.size() || text_[next] == '\n' || text_[next] == '\r')
                fail_at_line(obj_.file, 2 + std::count(text_.begin(), text_.begin() + end, '\n'),
                             "a face needs at least three corners");
        }
    }

    void add_triangle(uint32_t a, uint32_t b, uint32_t c) {
        if (obj_.triangle_materials.size() == max_triangle_count) fail("there are more than 2^28 - 1 triangles");
        const size_t capacity = obj_.corners.capacity();  // doubles when it is used up
        if (obj_.corners.size() == capacity && 2 * capacity * sizeof(ObjCorner) > memory_limit(text_.size()))
            fail("its triangles need far more memory than a file of its size should");
        obj_.corners.insert(obj_.corners.end(), {face_[a], face_[b], face_[c]});
        obj_.triangle_materials.push_back(*material_);
        obj_.triangle_lines.push_back(static_cast<uint32_t>(buffer_.last_line_number()));
    }

    void read_library(const std::filesystem::path& file) {
        if (!libraries_.insert(file.lexically_normal()).second) return;  // already read: the first material of a name counts
        for (MtlMaterial& material : read_mtl(file, path_.parent_path(), files_, warnings_)) {
            material_indices_.emplace(material.name, static_cast<uint32_t>(obj_.materials.size()));
            obj_.materials.push_back(std::move(material));
        }
    }

    void use_material() {
        const std::string name(name_in(buffer_.last_line()));
        const auto found = material_indices_.find(name);
        if (found == material_indices_.end()) note_missing("there is no material " + in_quotes(name));
        material_ = found == material_indices_.end() ? grey_ : found->second;
    }

    // Models from elsewhere often lack their materials: they are rendered grey, and the first missing one is named.
    void note_missing(const std::string& what) {
        if (missing_.empty()) missing_ = obj_.file + ":" + std::to_string(buffer_.last_line_number()) + ": " + what;
    }

    static MtlMaterial grey_material() {
        Material material{};
        material.diffuse_albedo = vec3(0.5f);
        material.albedo_texture = -1;
        return {"", material, {}};
    }

    const std::filesystem::path& path_;
    SourceFiles& files_;
    std::vector<std::string>& warnings_;
    std::string text_;
    TextBuffer buffer_;
    ObjFile obj_;
    std::vector<ObjCorner> face_;
    std::unordered_map<std::string, uint32_t> material_indices_;
    std::optional<uint32_t> material_;  // of the next face, if usemtl named one
    std::optional<uint32_t> grey_;
    std::set<std::filesystem::path> libraries_;  // material files that were read
    size_t library_names_ = 0;                   // tried so far
    std::string missing_;                        // the first material or material file, with its line
    size_t faces_without_material_ = 0;
};

}  // namespace

ObjFile read_obj(const std::filesystem::path& file, SourceFiles& files, std::vector<std::string>& warnings) {
    return ObjReader(file, files, warnings).read();
}

}  // namespace lab
