// The material of what has none.
const uint NO_MATERIAL = 0xffffffffu;

// What an estimator needs to know about the point x_k that a ray hits.
struct ShadingData {
    vec3 position;          // x_k, in scene units
    vec3 out_direction;     // ω_o = -ω_{k-1}, unit length: from x_k back along the ray
    vec3 normal;            // n(x_k), interpolated, unit length, on the same side as the geometric normal
    vec3 geometric_normal;  // of the triangle, unit length, on the side of out_direction
    float offset;           // distance off the surface at which rays must start to miss it, in scene units
    vec3 emission;          // L_e(x_k, ω_o), the emitted radiance
    float light_density;    // p_A, the density of light samples at x_k with respect to area; 0 where it does not emit
#ifdef FEATURE_LIGHT_TREE
    uint light;  // place of the triangle in light_leaves, if it emits
#endif
    uint material;          // index into the scene's materials, or NO_MATERIAL in a medium
    vec3 diffuse_albedo;    // in [0,1]: the fraction of light that is reflected diffusely, per colour channel
#ifdef FEATURE_SPECULAR
    vec3 specular_albedo;     // fraction of light that the Phong lobe reflects, per colour channel, in [0,1]
    float specular_exponent;  // n of the Phong lobe
#endif
    vec2 texture_coordinates;  // u and v, (0,0) in scenes without textures
    bool is_dielectric;    // whether it is smooth glass, which scatters into single directions
    float relative_index;  // η of a dielectric: refractive index beyond the surface over that on the ray's side
    vec3 transmittance;    // fraction of light that passes from the ray's origin to x_k, per colour channel
#ifdef FEATURE_MICROFACETS
    float roughness;           // α of its microfacets, in [0,1]; 0 if it has none
    float metalness;           // fraction that is metal, in [0,1]
    bool is_rough_dielectric;  // its microfacets transmit light; is_dielectric is false then
#endif
};

// A point on a triangle, on a ray or on a light.
struct SurfacePoint {
    vec3 position;
    vec3 geometric_normal;  // unit length
    float offset;           // as in ShadingData
};

vec3 interpolate(vec3 a, vec3 b, vec3 c, vec3 weights) { return weights.x * a + weights.y * b + weights.z * c; }

// The largest absolute value among the three components.
float max_component(vec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }

// The unit vector along v. Scales v first, since the squared length of a tiny or huge vector under- or overflows.
vec3 normalize_scaled(vec3 v) { return normalize(v / max_component(v)); }

// The barycentric coordinates w_0, w_1, w_2 of a hit.
vec3 get_vertex_weights(Hit hit) { return vec3(1.0 - hit.barycentrics.x - hit.barycentrics.y, hit.barycentrics); }

// The cross product of a triangle's edges, scaled to unit size: its length is about the triangle's height over its length.
vec3 get_scaled_normal(vec3 edge_1, vec3 edge_2) {
    float size = max(max_component(edge_1), max_component(edge_2));
    return cross(edge_1 / size, edge_2 / size);
}

const float ROUNDING = 5.9604645e-8;  // 2^-24, the largest relative error of one operation

// The distance off a triangle at which a ray must start to miss it: a bound on rounding errors of relative size 2^-24 in the
// position, whose coordinates have the given magnitudes, and in the intersection with the same triangle. Measured: no
// self-intersections from a factor of 4 on; we use 8. Intersections with slender triangles are less accurate. Limiting the
// slenderness keeps rays from skipping what is close to a very slender triangle.
float get_error_bound(vec3 magnitude, vec3 scaled_normal) {
    float slenderness = 1.0 / max(max_component(scaled_normal), 1.0 / 256.0);  // about length over height
    return 8.0 * ROUNDING * (magnitude.x + magnitude.y + magnitude.z) * slenderness;
}

#include "world/surface_point.glsl"  // get_surface_point()

#ifdef FEATURE_LIGHT_TREE
// The place of an emissive triangle in light_leaves.
uint get_light_place(uint instance, uint triangle) {
    return light_places[triangle] + light_places[uint(triangles.length()) + instance];
}
#endif

// Computes the shading data where a ray with this unit direction hits.
ShadingData get_shading_data(Hit hit, vec3 ray_direction) {
    SurfacePoint point = get_surface_point(hit);
    bool is_front = dot(point.geometric_normal, ray_direction) < 0.0;
#ifdef FEATURE_DOUBLE_SIDED
    // A ray may find either of two coincident triangles that face opposite ways. It sees the one that faces it.
    if (!is_front && other_sides[hit.triangle] != hit.triangle) {
        is_front = true;
        hit.triangle = other_sides[hit.triangle];
        hit.barycentrics = hit.barycentrics.yx;
        point.geometric_normal = -point.geometric_normal;
    }
#endif
    ShadingData s;
    s.position = point.position;
    s.out_direction = -ray_direction;
    s.geometric_normal = point.geometric_normal;
    s.offset = point.offset;
    s.normal = s.geometric_normal;
#if defined(FEATURE_VERTEX_NORMALS) || defined(FEATURE_TEXTURES)
    vec3 w = get_vertex_weights(hit);
    uvec3 corners = triangles[hit.triangle];
#endif
#ifdef FEATURE_VERTEX_NORMALS
    vec3 normal = interpolate(normals[corners.x], normals[corners.y], normals[corners.z], w);
#ifdef FEATURE_TRANSFORMS
    normal = instances[hit.instance].normal_to_world * normal;
#endif
    // Vertex normals may cancel each other out: then the geometric normal has to do.
    if (normal != vec3(0.0)) s.normal = normalize_scaled(normal);
#endif

    s.material = triangle_materials[hit.triangle];
    Material material = materials[s.material];
    s.diffuse_albedo = material.diffuse_albedo;
    s.texture_coordinates = vec2(0.0);
#ifdef FEATURE_TEXTURES
    // Textures repeat. Without the integer part, coordinates far from 0 are as accurate as others.
    vec2 uv = texture_coordinates[corners.x];
    s.texture_coordinates = fract(uv) + w.y * (texture_coordinates[corners.y] - uv) +
                            w.z * (texture_coordinates[corners.z] - uv);
    if (material.albedo_texture >= 0)
        s.diffuse_albedo *= get_texture_colour(material.albedo_texture, s.texture_coordinates);
#endif
#ifdef FEATURE_SPECULAR
    s.specular_albedo = material.specular_albedo;
    s.specular_exponent = material.specular_exponent;
#endif
    // Emitters emit from the front. Surfaces reflect on both sides, so from here on both normals face the ray's origin.
    s.emission = is_front ? material.emission : vec3(0.0);
    s.light_density = 0.0;
#ifdef FEATURE_LIGHT_TRIANGLES
    if (is_front) s.light_density = material.light_density;
#endif
#ifdef FEATURE_LIGHT_TREE
    s.light = get_light_place(hit.instance, hit.triangle);
#endif
    if (!is_front) {
        s.geometric_normal = -s.geometric_normal;
        s.normal = -s.normal;
    }
    s.is_dielectric = false;
    s.transmittance = vec3(1.0);
#ifdef FEATURE_DIELECTRICS
    s.is_dielectric = hit.material_class == MATERIAL_CLASS_DIELECTRIC;
    s.relative_index = is_front ? material.refractive_index : 1.0 / material.refractive_index;
#endif
#ifdef FEATURE_ABSORPTION
    // Beer's law: a ray that arrives at the back of a dielectric has travelled inside it.
    if (s.is_dielectric && !is_front) s.transmittance = exp(-material.absorption * hit.distance);
#endif
#ifdef FEATURE_MICROFACETS
    s.roughness = microfacets[s.material].roughness;
    s.metalness = microfacets[s.material].metalness;
    s.is_rough_dielectric = s.is_dielectric && s.roughness > 0.0;
    if (!s.is_dielectric) s.relative_index = microfacets[s.material].coat_index;
    s.is_dielectric = s.is_dielectric && !s.is_rough_dielectric;
#endif
    return s;
}

// A ray from a surface point into the given direction, of any length. Its origin is moved off the surface, to the side that the direction
// points to, by a bound on the rounding errors, so that the ray cannot hit the surface where it starts.
Ray get_ray_from_surface(ShadingData s, vec3 direction) {
    float side = dot(s.geometric_normal, direction) < 0.0 ? -1.0 : 1.0;
    return Ray(s.position + side * s.offset * s.geometric_normal, direction);
}

// A ray from a surface point towards another point: at distance 1 it is short of it by 64 rounding errors of its length. The offset
// in front of a light bounds what its own coordinates round off. The rounding of the ray's direction and of the hit grow with its
// length: without this, a light 15 units away with coordinates of 1 hid 36 % of itself from Embree and 4 % from `compute`, now it
// hides 1e-6, in grazing rays. With 16 roundings 1e-5.
Ray get_ray_to_point(ShadingData s, vec3 point) {
    Ray ray = get_ray_from_surface(s, point - s.position);
    ray.direction = (1.0 - 64.0 * ROUNDING) * (point - ray.origin);
    return ray;
}

// Whether light can leave x along the unit direction: above the horizon of the shading normal and of the triangle.
bool is_above_surface(ShadingData s, vec3 direction) {
#ifdef FEATURE_MICROFACETS
    // Through a rough dielectric it also leaves below both.
    if (s.is_rough_dielectric) return dot(s.normal, direction) * dot(s.geometric_normal, direction) > 0.0;
#endif
    return dot(s.normal, direction) > 0.0 && dot(s.geometric_normal, direction) > 0.0;
}
