// Replaces a chapter's estimator and shows the hemisphere over a shading point as three discs side by side, one for each factor
// of the rendering equation's integrand L_i(x, ω) ρ(x, ω, ω_o) n·ω. The incoming radiance L_i is what the chapter estimates along
// the ray x, ω.
//
// The discs are equal-area maps (Lambert): every pixel covers the same solid angle. The normal is in the middle, the horizon at
// the rim; the hemisphere is seen from above.
#include "observation/shading_point.h"

#include "observation/observed_estimator.glsl"

layout(scalar, set = 0, binding = BINDING_SHADING_POINT) readonly buffer ShadingPointBuffer {
    ShadingPoint shading_point;
};

// Direction about the z-axis for a position in the unit disc: cos θ = 1 - r².
vec3 get_hemisphere_direction(vec2 position) {
    float square = dot(position, position);
    return vec3(position * sqrt(2.0 - square), 1.0 - square);
}

// As get_shading_space(), but turned so that the second column is upwards where possible.
mat3 get_upright_space(vec3 normal, vec3 up) {
    vec3 bitangent = up - dot(up, normal) * normal;
    if (length(bitangent) < 1e-3) return get_shading_space(normal);
    bitangent = normalize(bitangent);
    return mat3(cross(bitangent, normal), bitangent, normal);
}

vec3 path_trace(Ray ray, inout uvec2 seed) {
    // The camera looks along z, so its ray gives the position in the image of three discs.
    vec2 position = vec2(3.0 * ray.direction.x, ray.direction.y) / ray.direction.z;
    float disc = clamp(floor(0.5 * (position.x + 3.0)), 0.0, 2.0);
    position.x -= 2.0 * disc - 2.0;
    if (dot(position, position) >= 1.0) return vec3(0.0);

    Hit hit;
    hit.instance = shading_point.instance;
    hit.triangle = shading_point.triangle;
    hit.barycentrics = shading_point.barycentrics;
    hit.distance = 0.0;
#ifdef FEATURE_DIELECTRICS
    hit.material_class = get_material_class(hit.triangle);
#endif
    ShadingData s = get_shading_data(hit, shading_point.ray_direction);
    vec3 omega = get_upright_space(s.normal, shading_point.up) * get_hemisphere_direction(position);
    if (disc == 2.0) return vec3(max(dot(s.normal, omega), 0.0));
    if (!is_above_surface(s, omega)) return vec3(0.0);
    if (disc == 1.0) return get_brdf(s, omega);
    return observed_path_trace(get_ray_from_surface(s, omega), seed);
}
