// Three ways to sample a direction.
const uint SAMPLES_VISIBLE_NORMALS = 0u;  // by the normal of a visible facet
const uint SAMPLES_NORMALS = 1u;          // by that of any facet
const uint SAMPLES_COSINES = 2u;          // by the cosine alone; glass, which has no diffuse light, still by visible normals
// How a direction is sampled: one of the constants above, which --facet-sampling chooses.
#ifndef FACET_SAMPLING
#define FACET_SAMPLING SAMPLES_VISIBLE_NORMALS
#endif
#ifdef FEATURE_MICROFACETS

// A normal with density D(m) n·m, about the z-axis: tan² θ = α² u / (1 - u).
vec3 sample_any_normal(float alpha, vec2 u) {
    float cos_theta = sqrt((1.0 - u.x) / (1.0 - u.x + alpha * alpha * u.x));
    float sin_theta = alpha * sqrt(u.x / (1.0 - u.x + alpha * alpha * u.x));
    float phi = 2.0 * PI * u.y;
    return vec3(cos(phi) * sin_theta, sin(phi) * sin_theta, cos_theta);
}

// A normal of the facets that are visible from ω_o. Stretched by 1/α along n, GGX's facets are those of a round sphere, and a
// direction (x, y, z) points along (αx, αy, z). The visible ones reflect light from ω_o evenly into the cap of directions
// z > -z_o, so that we sample a direction there and go halfway. When the sphere becomes flat again, its slopes become α times as
// steep: x and y of the normal are multiplied by α, too (Dupuy and Benyoub, "Sampling Visible GGX Normals with Spherical Caps",
// HPG 2023).
vec3 sample_visible_normal(vec3 out_direction, float alpha, vec2 u) {
    vec3 view = normalize(vec3(alpha * out_direction.xy, out_direction.z));
    // Seen from the stretched direction the hemisphere is half a disc and half an ellipse (Heitz, "Sampling the GGX Distribution of
    // Visible Normals", JCGT 7(4) 2018).
    float length_squared = dot(view.xy, view.xy);
    vec3 right = length_squared > 0.0 ? vec3(-view.y, view.x, 0.0) * inversesqrt(length_squared) : vec3(1.0, 0.0, 0.0);
    vec3 up = cross(view, right);
    float radius = sqrt(u.x), phi = 2.0 * PI * u.y;
    float a = radius * cos(phi), b = radius * sin(phi);
    float share = 0.5 * (1.0 + view.z);
    b = mix(sqrt(max(1.0 - a * a, 0.0)), b, share);
    vec3 normal = a * right + b * up + sqrt(max(1.0 - a * a - b * b, 0.0)) * view;
    return normalize(vec3(alpha * normal.xy, max(normal.z, 1e-7)));
}

// A normal about the z-axis for a direction ω_o above, and the density of get_normal_density().
vec3 sample_normal(vec3 out_direction, float alpha, vec2 u) {
    if (FACET_SAMPLING == SAMPLES_NORMALS) return sample_any_normal(alpha, u);
    return sample_visible_normal(out_direction, alpha, u);
}

// The density of sample_normal() with respect to solid angle. The fraction G_1 of the facets is visible, and from ω_o each appears
// larger by ω_o·m / n·ω_o.
float get_normal_density(ShadingData s, Facet facet) {
    float distribution = get_facet_distribution(s, facet.normal);
    if (FACET_SAMPLING == SAMPLES_NORMALS) return distribution * dot(s.normal, facet.normal);
    float cos_o = dot(s.normal, s.out_direction);
    return distribution * 2.0 * facet.cos_o / (cos_o + get_smith_term(s, cos_o));
}
#endif
