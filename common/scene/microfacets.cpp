#include "scene/microfacets.h"

#include <cmath>
#include <numbers>

namespace lab {
namespace {

using glm::dvec2;
using glm::dvec3;

constexpr uint32_t entries = MICROFACET_ALBEDO_COUNT;

// Fresnel reflectance for unpolarised light that arrives from outside the coat.
double get_reflectance(double cosine, double index) {
    const double refracted = std::sqrt(index * index - 1 + cosine * cosine);
    const double s = (cosine - refracted) / (cosine + refracted);
    const double p = (index * index * cosine - refracted) / (index * index * cosine + refracted);
    return index == 1 ? 0 : 0.5 * (s * s + p * p);
}

// Reflectance of a single bounce for light from this direction: the mean of F G2/G1 over the visible normals, with and without F.
dvec2 integrate_direction(double alpha, double cosine, double index) {
    constexpr int rows = 64, columns = 32;
    const auto smith_term = [&](double c) { return std::sqrt(alpha * alpha * (1 - c * c) + c * c); };
    const double sine = std::sqrt(1 - cosine * cosine);
    const dvec3 out(sine, 0, cosine), stretched = glm::normalize(dvec3(alpha * sine, 0, cosine));
    dvec2 sum(0);
    for (int i = 0; i < rows; ++i) {
        // More rows where normals are steep, since those lose energy.
        const double rest = 1 - (i + 0.5) / rows, u = 1 - rest * rest * rest;
        for (int j = 0; j < columns; ++j) {
            // A visible normal as in the shaders. Both sides of the plane of incidence reflect the same.
            const double phi = std::numbers::pi * (j + 0.5) / columns, z = 1 - u * (1 + stretched.z);
            const double radius = std::sqrt(1 - z * z);
            const dvec3 half = dvec3(radius * std::cos(phi), radius * std::sin(phi), z) + stretched;
            const dvec3 normal = glm::normalize(dvec3(alpha * half.x, alpha * half.y, half.z));
            const double facet_cosine = glm::dot(out, normal), in_cosine = 2 * facet_cosine * normal.z - cosine;
            if (in_cosine <= 0) continue;
            const double out_term = smith_term(cosine), in_term = smith_term(in_cosine);
            const double visible = in_cosine * (cosine + out_term) / (cosine * in_term + in_cosine * out_term);
            sum += 3 * rest * rest * visible * dvec2(get_reflectance(facet_cosine, index), 1);
        }
    }
    return sum / double(rows * columns);
}

// 2 ∫ E(μ) μ dμ of the polygon through the entries at μ = (i / (n-1))², as the shaders interpolate it.
vec2 get_mean(const vec2 (&albedo)[entries]) {
    constexpr uint32_t steps = 32;  // between two entries
    dvec2 sum(0);
    double weights = 0;
    for (uint32_t k = 0; k < steps * (entries - 1); ++k) {
        const double position = (k + 0.5) / steps, weight = std::pow(position, 3);  // μ dμ
        const uint32_t i = k / steps;
        sum += weight * glm::mix(dvec2(albedo[i]), dvec2(albedo[i + 1]), position - i);
        weights += weight;
    }
    return sum / weights;
}

}  // namespace

void integrate_albedo(Microfacets& microfacets) {
    for (uint32_t i = 0; i < entries; ++i)
        microfacets.albedo[i] =
            integrate_direction(microfacets.roughness, std::pow(i / (entries - 1.0), 2), microfacets.coat_index);
    microfacets.mean_albedo = get_mean(microfacets.albedo);
}

}  // namespace lab
