#include "support/dielectric_scenes.h"

namespace lab {

Material dielectric_material(float refractive_index, const vec3& absorption) {
    Material material = diffuse_material(vec3(0));
    material.refractive_index = refractive_index;
    material.absorption = absorption;
    return material;
}

// The materials of the contents follow those of the room.
static Scene make_room(const std::vector<Material>& content_materials, const std::vector<Quad>& contents) {
    std::vector<Material> materials{diffuse_material({0.7f, 0.5f, 0.3f}), diffuse_material(vec3(0.5f), {2, 3, 4})};
    materials.insert(materials.end(), content_materials.begin(), content_materials.end());
    std::vector<Quad> quads = box_sides(vec3(-1), vec3(1), 0, Facing::inwards);
    quads.push_back({{-0.7f, 0.95f, -0.7f}, {1.4f, 0, 0}, {0, 0, 1.4f}, 1});
    quads.insert(quads.end(), contents.begin(), contents.end());
    Scene scene = make_scene(materials, quads);
    scene.camera = {.position = {0.1f, 0.2f, 0.98f}, .target = {0, -0.1f, -1}, .up = {0, 1, 0}, .vertical_fov = 75};
    return scene;
}

Scene room_with_box(const Material& box, const vec3& low, const vec3& high) {
    return make_room({box}, box_sides(low, high, 2, Facing::outwards));
}

Scene empty_room() { return make_room({}, {}); }

Scene glass_with_lamp(const Material& glass) {
    std::vector<Quad> quads{{{-0.8f, -0.6f, -0.8f}, {0, 0, 1.6f}, {1.6f, 0, 0}, 0},
                            {{-0.5f, 0.6f, -0.5f}, {1, 0, 0}, {0, 0, 1}, 1}};
    for (const Quad& side : box_sides(vec3(-1), vec3(1), 2, Facing::outwards)) quads.push_back(side);
    Scene scene = make_scene({diffuse_material(vec3(0.7f)), diffuse_material(vec3(0.5f), {2, 3, 4}), glass}, quads);
    scene.background = vec3(0.2f);
    scene.camera = {.position = {0.3f, 0.2f, 3}, .target = {0, -0.1f, 0}, .up = {0, 1, 0}, .vertical_fov = 30};
    return scene;
}

}  // namespace lab
