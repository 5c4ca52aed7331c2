#include "hard_cases/probe.h"

#include <cstdio>

#include "files/project_folder.h"
#include "scene/light_table.h"

namespace lab {

Estimator probe(const std::string& name) { return {project_folder() / "tests" / "hard_cases" / (name + ".glsl")}; }

glm::dvec3 probe_total(const Scene& scene, const RenderSettings& settings) {
    glm::dvec3 total(0);
    for (const FilmPixel& pixel : render(scene, settings).pixels) total += glm::dvec3(pixel.sum) + glm::dvec3(pixel.compensation);
    return total;
}

std::vector<std::string> chapters_for(Backend backend, std::vector<std::string> all) {
    if (backend != compute_backend) all.resize(1);
    return all;
}

double light_probability_sum(const Scene& scene) {
    double sum = 0;
    for (const LightTriangle& light : build_light_table(scene).triangles) {
        const uvec3 corners = scene.triangles[light.triangle];
        const auto position = [&](int k) { return glm::dvec3(scene.positions[corners[k]]); };
        const double area = 0.5 * glm::length(glm::cross(position(1) - position(0), position(2) - position(0)));
        sum += area / static_cast<double>(light.inverse_density);
    }
    return sum;
}

static std::string format(const char* pattern, double a, double b = 0) {
    char text[64];
    std::snprintf(text, sizeof text, pattern, a, b);
    return text;
}

std::string out_of(double count, double total) { return format("%.0f of %.3g", count, total); }

std::string percent(double fraction) { return format("%+.3g %%", 100 * fraction); }

}  // namespace lab
