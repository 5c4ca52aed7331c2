#include "support/microfacet_model.h"

#include <cmath>
#include <numbers>

namespace lab {
namespace {

using glm::dvec3;
using std::numbers::pi;

double tangent_of(double cosine) { return std::sqrt(std::max(1 - cosine * cosine, 0.0)) / std::abs(cosine); }

// Averages `contribution`, a function of the facet's normal, over the facets, weighted by D n·m.
double average(const FacetModel& model, const std::function<double(const dvec3&)>& contribution) {
    constexpr int count = 1500, turns = 200;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        // Many facets are nearly level and few are steep, but at grazing angles those matter: u close to 1 is sampled densely.
        const double x = (i + 0.5) / count, u = 1 - (1 - x) * (1 - x) * (1 - x);
        const double square = model.tangent_square(u), cosine = 1 / std::sqrt(1 + square), sine = std::sqrt(square) * cosine;
        double around = 0;
        for (int j = 0; j < turns; ++j) {
            const double phi = pi * (j + 0.5) / turns;
            around += contribution({sine * std::cos(phi), sine * std::sin(phi), cosine});
        }
        sum += 3 * (1 - x) * (1 - x) * around / turns;
    }
    return sum / count;
}

}  // namespace

FacetModel ggx(double alpha) {
    return {[=](double u) { return alpha * alpha * u / (1 - u); },
            [=](double tangent) { return 0.5 * (std::sqrt(1 + alpha * alpha * tangent * tangent) - 1); }};
}

FacetModel beckmann(double alpha) {
    return {[=](double u) { return -alpha * alpha * std::log1p(-u); },
            [=](double tangent) {
                const double b = 1 / (alpha * tangent);
                return b < 1.6 ? (1 + 2.276 * b + 2.577 * b * b) / (3.535 * b + 2.181 * b * b) - 1 : 0;
            },
            false};
}

double dielectric_fresnel(double cosine, double index) {
    const double square = index * index - 1 + cosine * cosine;
    if (square <= 0) return 1;
    const double s = (cosine - std::sqrt(square)) / (cosine + std::sqrt(square));
    const double p = (index * index * cosine - std::sqrt(square)) / (index * index * cosine + std::sqrt(square));
    return 0.5 * (s * s + p * p);
}

double integrate_reflected(const FacetModel& model, double cosine, const std::function<double(double)>& fresnel) {
    const dvec3 out(std::sqrt(1 - cosine * cosine), 0, cosine);
    const double out_lambda = model.lambda(tangent_of(cosine));
    return average(model, [&](const dvec3& m) {
        const double m_o = glm::dot(m, out), in_cosine = 2 * m_o * m.z - cosine;
        if (m_o <= 0 || in_cosine <= 0) return 0.0;
        const double in_lambda = model.lambda(tangent_of(in_cosine));
        const double masking = model.is_correlated ? 1 / (1 + in_lambda + out_lambda) : 1 / ((1 + in_lambda) * (1 + out_lambda));
        return fresnel(m_o) * masking * m_o / (cosine * m.z);
    });
}

double integrate_refracted(const FacetModel& model, double cosine, double index) {
    const dvec3 out(std::sqrt(1 - cosine * cosine), 0, cosine);
    const double out_lambda = model.lambda(tangent_of(cosine));
    return average(model, [&](const dvec3& m) {
        const double m_o = glm::dot(m, out), square = index * index - 1 + m_o * m_o;
        if (m_o <= 0 || square <= 0) return 0.0;
        const double in_cosine = ((m_o - std::sqrt(square)) * m.z - cosine) / index;
        if (in_cosine >= 0) return 0.0;
        const double in_lambda = model.lambda(tangent_of(in_cosine));
        return (1 - dielectric_fresnel(m_o, index)) / ((1 + in_lambda) * (1 + out_lambda)) * m_o / (cosine * m.z);
    });
}

}  // namespace lab
