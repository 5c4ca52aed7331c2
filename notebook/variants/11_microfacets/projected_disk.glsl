// Visible normals by the disk onto which ω_o projects the half sphere that it sees (Heitz, "Sampling the GGX Distribution of
// Visible Normals", JCGT 7(4) 2018), and G_1 by the tangent. There is no other way to sample.
const uint SAMPLES_COSINES = 2u;
#define FACET_SAMPLING 0u
#ifdef FEATURE_MICROFACETS

vec3 sample_normal(vec3 out_direction, float alpha, vec2 u) {
    vec3 pole = normalize(vec3(alpha, alpha, 1.0) * out_direction);
    mat3 seen = mat3(1.0);
    seen[2] = pole;
    seen[0] = dot(pole.xy, pole.xy) > 0.0 ? normalize(vec3(-pole.y, pole.x, 0.0)) : seen[0];
    seen[1] = cross(pole, seen[0]);
    // The lower half of the disk is squeezed to the half ellipse that lies above the horizon.
    vec2 on_disk = sqrt(u.y) * vec2(cos(2.0 * PI * u.x), sin(2.0 * PI * u.x));
    on_disk.y = mix(sqrt(1.0 - on_disk.x * on_disk.x), on_disk.y, 0.5 + 0.5 * pole.z);
    vec3 on_sphere = seen * vec3(on_disk, sqrt(max(1.0 - dot(on_disk, on_disk), 0.0)));
    return normalize(vec3(alpha * on_sphere.xy, max(on_sphere.z, 0.0)));
}

float get_normal_density(ShadingData s, Facet facet) {
    float cos_o = dot(s.normal, s.out_direction);
    float tangent = length(cross(s.normal, s.out_direction)) / cos_o;
    float visible = 2.0 / (1.0 + sqrt(1.0 + s.roughness * s.roughness * tangent * tangent));
    float share = visible * facet.cos_o / cos_o;
    return share * get_facet_distribution(s, facet.normal);
}
#endif
