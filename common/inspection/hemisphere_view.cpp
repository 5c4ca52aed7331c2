#include "inspection/hemisphere_view.h"

#include "files/project_folder.h"
#include "shaders/observation/shading_point.h"

namespace lab {
namespace {

constexpr uvec2 image_size(3 * HemisphereView::extent, HemisphereView::extent);

Estimator hemisphere_estimator(const Estimator& estimator) {
    return {.file = project_folder() / "shaders" / "observation" / "view_hemisphere.glsl",
            .defines = estimator.defines,
            .observed = estimator.file,
            .edit = estimator.edit};
}

RenderParameters with_size(RenderParameters parameters) {
    parameters.image_size = image_size;
    return parameters;
}

Image cut(const Image& image, uint32_t left, uint32_t width) {
    Image part{width, image.height, {}};
    for (uint32_t y = 0; y < image.height; ++y) {
        const auto row = image.pixels.begin() + 3 * (size_t{y} * image.width + left);
        part.pixels.insert(part.pixels.end(), row, row + 3 * width);
    }
    return part;
}

}  // namespace

HemisphereView::HemisphereView(const Device& device, const SceneBackend& scene_backend, const Estimator& estimator)
    : point_(device, sizeof(ShadingPoint), vk::BufferUsageFlagBits::eStorageBuffer),
      renderer_(device, scene_backend, hemisphere_estimator(estimator), with_size({}),
                std::vector{storage_binding(BINDING_SHADING_POINT, point_)}) {}

void HemisphereView::look_at(const PathVertex& vertex, const RenderParameters& parameters) {
    // Up in the disc is what lies further up, or further away, in the rendered picture.
    const ShadingPoint point{.instance = vertex.instance,
                             .triangle = vertex.triangle,
                             .barycentrics = vertex.barycentrics,
                             .ray_direction = vertex.direction,
                             .up = glm::normalize(parameters.camera.up) + parameters.camera.forward};
    point_.write(&point, sizeof point);
    RenderParameters of_view = with_size(parameters);
    of_view.camera = {vec3(0), vec3(0, 0, 1), vec3(1, 0, 0), vec3(0, 1, 0), 0, 1};
    of_view.first_sample = 0;
    // The bounce at the point itself counts towards the path length.
    if (of_view.max_path_length > 0) --of_view.max_path_length;
    if (of_view.only_path_length > 0) --of_view.only_path_length;
    renderer_.restart(of_view);
}

HemisphereView::Pictures HemisphereView::pictures() const {
    const Image all = renderer_.film().read().mean();
    return {cut(all, 0, extent), cut(all, extent, extent), cut(all, 2 * extent, extent)};
}

vec3 HemisphereView::Pictures::reflected_radiance() const {
    glm::dvec3 sum(0);
    for (size_t i = 0; i < incoming_radiance.pixels.size(); ++i)
        sum[static_cast<int>(i % 3)] += double{incoming_radiance.pixels[i]} * double{brdf.pixels[i]} * double{cosine.pixels[i]};
    return vec3(8.0 / (double{extent} * extent) * sum);
}

}  // namespace lab
