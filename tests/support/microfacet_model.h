// The microfacet model in double, straight from its definitions: the reference for the shaders.
#pragma once
#include <functional>
#include <glm/glm.hpp>

namespace lab {

// The distribution of facets in terms of tan² θ_m, and Smith's Λ for a direction with this tangent.
struct FacetModel {
    // tan² θ_m below which a fraction u of D n·m lies.
    std::function<double(double u)> tangent_square;
    std::function<double(double tangent)> lambda;
    // 1 / (1 + Λ_i + Λ_o), or else the product of both sides' G_1.
    bool is_correlated = true;
};
FacetModel ggx(double alpha);
FacetModel beckmann(double alpha);  // with Λ by Walter's rational approximation

// Fresnel's reflectance of a dielectric, 1 for total internal reflection.
double dielectric_fresnel(double cosine, double index);

// The fraction of light from this direction that the facets reflect: an integral over all facets, with `fresnel` of ω·m.
double integrate_reflected(const FacetModel& model, double cosine, const std::function<double(double)>& fresnel);

// The fraction of light that passes facets of glass whose other side has this index.
double integrate_refracted(const FacetModel& model, double cosine, double index);

}  // namespace lab
