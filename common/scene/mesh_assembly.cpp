#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "error.h"
#include "image/image_checks.h"
#include "scene/coincident_lights.h"
#include "scene/material_keywords.h"
#include "scene/microfacets.h"
#include "scene/obj_file.h"

namespace lab {
namespace {

using glm::dvec3;

// Larger exponents make lobes narrower than 32-bit directions can resolve.
constexpr float largest_exponent = 1e8f;

constexpr size_t max_albedos = 1024;  // takes some seconds

struct CornerHash {
    size_t operator()(const ObjCorner& corner) const {
        uint64_t hash = corner.position;
        for (const uint32_t index : {corner.texture_coordinates, corner.normal})
            hash = (hash ^ index) * 0x9e3779b97f4a7c15u, hash ^= hash >> 32;
        return hash;
    }
};

// Whether a vector has a direction. (In double, the square of a float neither overflows nor underflows.)
bool has_direction(const dvec3& vector) {
    const double square = glm::dot(vector, vector);
    return square > 0 && std::isfinite(square);
}

bool has_normals(const ObjFile& obj) {
    return std::ranges::any_of(obj.corners, [&](const ObjCorner& corner) {
        return corner.normal != ObjCorner::none && has_direction(dvec3(obj.normals[corner.normal]));
    });
}

bool has_textures(const ObjFile& obj) {
    return std::ranges::any_of(obj.triangle_materials,
                               [&](uint32_t material) { return !obj.materials[material].albedo_texture.empty(); });
}

class Assembly {
  public:
    Assembly(const std::vector<ObjFile>& files, bool specular, SourceFiles& sources, Scene& scene)
        : specular_(specular),
          sources_(sources),
          scene_(scene),
          with_normals_(std::ranges::any_of(files, has_normals)),
          with_texture_coordinates_(std::ranges::any_of(files, has_textures)) {}

    void add(const ObjFile& obj) {
        vertices_.clear();
        vertices_.reserve(obj.positions.size());
        Mesh mesh{obj.file, static_cast<uint32_t>(scene_.triangles.size())};
        std::vector<uint32_t> scene_materials(obj.materials.size(), ObjCorner::none), lines;
        size_t dropped = 0;
        for (const bool dielectric : {false, true}) {
            for (size_t i = 0; i < obj.triangle_materials.size(); ++i) {
                const uint32_t source = obj.triangle_materials[i];
                if ((obj.materials[source].material.refractive_index > 0) != dielectric) continue;
                if (!add_triangle(obj, &obj.corners[3 * i])) {
                    ++dropped;
                    continue;
                }
                if (scene_materials[source] == ObjCorner::none)
                    scene_materials[source] = add_material(obj, obj.materials[source]);
                scene_.triangle_materials.push_back(scene_materials[source]);
                lines.push_back(obj.triangle_lines[i]);
                ++mesh.triangle_count;
                if (dielectric) ++mesh.dielectric_count;
            }
        }
        if (mesh.triangle_count == 0) throw UserError(obj.file + ": none of its triangles has an area");
        if (dropped > 0)
            scene_.warnings.push_back(obj.file + ": " + std::to_string(dropped) + " triangles without area are left out");
        resolve_coincident_lights(scene_, mesh, lines);
        scene_.meshes.push_back(mesh);
    }

  private:
    // Returns false if the triangle has no area and hence no normal.
    bool add_triangle(const ObjFile& obj, const ObjCorner* source) {
        ObjCorner corners[3] = {source[0], source[1], source[2]};
        const dvec3 origin(obj.positions[corners[0].position]);
        dvec3 normal =
            glm::cross(dvec3(obj.positions[corners[1].position]) - origin, dvec3(obj.positions[corners[2].position]) - origin);
        if (!has_direction(normal)) return false;
        normal = glm::normalize(normal);

        // The front is the side that the vertex normals are on.
        double side = 0;
        for (ObjCorner& corner : corners) {
            if (corner.normal == ObjCorner::none) continue;
            const dvec3 vertex_normal(obj.normals[corner.normal]);
            if (has_direction(vertex_normal))
                side += glm::dot(normal, glm::normalize(vertex_normal));
            else
                corner.normal = ObjCorner::none;
        }
        if (side < 0) {
            std::swap(corners[1], corners[2]);
            normal = -normal;
        }
        uvec3 triangle;
        for (int i = 0; i < 3; ++i) triangle[i] = add_vertex(obj, corners[i], normal);
        scene_.triangles.push_back(triangle);
        return true;
    }

    // Finds or adds a vertex. A corner with the geometric normal, which belongs to one triangle, is not shared.
    uint32_t add_vertex(const ObjFile& obj, ObjCorner corner, const dvec3& geometric_normal) {
        if (!with_texture_coordinates_) corner.texture_coordinates = ObjCorner::none;
        const auto next = static_cast<uint32_t>(scene_.positions.size());
        if (!with_normals_ || corner.normal != ObjCorner::none) {
            const auto [vertex, is_new] = vertices_.try_emplace(corner, next);
            if (!is_new) return vertex->second;
        }
        if (next == ObjCorner::none) throw UserError(obj.file + ": the scene has more than 2^32 vertices");
        scene_.positions.push_back(obj.positions[corner.position]);
        if (with_normals_)
            scene_.normals.emplace_back(corner.normal == ObjCorner::none ? geometric_normal
                                                                         : glm::normalize(dvec3(obj.normals[corner.normal])));
        if (with_texture_coordinates_) {
            const bool absent = corner.texture_coordinates == ObjCorner::none;
            const vec2 uv = absent ? vec2(0, 1) : obj.texture_coordinates[corner.texture_coordinates];
            // In the file v points up, in the scene down.
            scene_.texture_coordinates.emplace_back(uv.x, 1 - uv.y);
        }
        return next;
    }

    uint32_t add_material(const ObjFile& obj, const MtlMaterial& source) {
        Material material = source.material;
        if (!specular_) {
            if (material.specular_albedo != vec3(0) && !ignored_specular_) {
                scene_.warnings.push_back(obj.file + ": Ks is ignored, as the scene does not ask for specular");
                ignored_specular_ = true;
            }
            material.specular_albedo = vec3(0);
            material.specular_exponent = 0;
        }
        if (material.specular_exponent > largest_exponent) {
            scene_.warnings.push_back(obj.file + ": material " + in_quotes(source.name) +
                                      ": Ns above 1e8 makes a lobe that 32 bits cannot tell from a mirror's: it becomes 1e8");
            material.specular_exponent = largest_exponent;
        }
        limit_reflectance(obj, source.name, material);
        if (!source.albedo_texture.empty()) material.albedo_texture = add_texture(source.albedo_texture);
        scene_.materials.push_back(material);
        scene_.material_names.push_back(source.name);
        scene_.microfacets.push_back(source.microfacets);
        if (source.microfacets.coat_index > 0) add_albedo(obj, scene_.microfacets.back());
        return static_cast<uint32_t>(scene_.materials.size() - 1);
    }

    // Divides albedos by the largest channel of their sum if it exceeds 1.
    void limit_reflectance(const ObjFile& obj, const std::string& name, Material& material) {
        dvec3 albedo(0);
        std::string names;
        for (const MaterialKeyword& keyword : material_keywords) {
            if (!keyword.member.is_albedo || material.*keyword.member.colour == vec3(0)) continue;
            albedo += dvec3(material.*keyword.member.colour);
            names += (names.empty() ? "" : " and ") + std::string(keyword.name);
        }
        const double largest = std::max({albedo.x, albedo.y, albedo.z});
        if (largest <= 1) return;
        constexpr double noteworthy = 1e-6;  // more than 32 bits round: 0.2 + 0.8 exceeds 1, too
        if (largest > 1 + noteworthy)
            scene_.warnings.push_back(obj.file + ": material " + in_quotes(name) + " reflects more than it receives: " + names +
                                      (names.find(' ') == names.npos ? " is" : " are") + " divided by " +
                                      std::to_string(largest));
        // Rounded down, so that rounding errors cannot push the sum above 1.
        constexpr double rounding = 1 - 0x1p-23;
        for (const MaterialKeyword& keyword : material_keywords)
            if (keyword.member.is_albedo)
                material.*keyword.member.colour = vec3(dvec3(material.*keyword.member.colour) / largest * rounding);
    }

    // Materials often share their roughness, so few albedos need integrating.
    void add_albedo(const ObjFile& obj, Microfacets& microfacets) {
        const auto [known, is_new] = albedos_.try_emplace({microfacets.roughness, microfacets.coat_index}, microfacets);
        if (albedos_.size() > max_albedos)
            throw UserError(obj.file + ": the materials have more than 1024 different pairs of Pr and Ni: round them");
        if (is_new) integrate_albedo(known->second);
        std::ranges::copy(known->second.albedo, microfacets.albedo);
        microfacets.mean_albedo = known->second.mean_albedo;
    }

    int add_texture(const std::filesystem::path& file) {
        const auto [texture, is_new] = textures_.try_emplace(file.lexically_normal(), static_cast<int>(scene_.textures.size()));
        if (is_new) {
            const std::vector<uint8_t>& pixels = scene_.textures.emplace_back(read_texture(file)).pixels;
            bool is_opaque = true;
            for (size_t i = 3; i < pixels.size(); i += 4) is_opaque &= pixels[i] == 255;
            if (!is_opaque)
                scene_.warnings.push_back(printable(file.string()) + ": its alpha has no effect: d makes a material transparent");
            sources_.read(file, max_image_file_bytes);  // for the hash
        }
        return texture->second;
    }

    const bool specular_;
    SourceFiles& sources_;
    Scene& scene_;
    const bool with_normals_;
    const bool with_texture_coordinates_;
    bool ignored_specular_ = false;
    std::unordered_map<ObjCorner, uint32_t, CornerHash> vertices_;  // of the current file
    std::map<std::filesystem::path, int> textures_;
    std::map<std::pair<float, float>, Microfacets> albedos_;
};

}  // namespace

void assemble_meshes(const std::vector<ObjFile>& files, bool specular, SourceFiles& sources, Scene& scene) {
    Assembly assembly(files, specular, sources, scene);
    for (const ObjFile& file : files) assembly.add(file);
    const auto is_smooth = [](const Microfacets& microfacets) { return microfacets.roughness == 0; };
    if (std::ranges::all_of(scene.microfacets, is_smooth)) scene.microfacets.clear();
}

}  // namespace lab
