// Rotation matrix Q whose third column is the unit normal: turns directions about the z-axis into directions about the
// normal. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1) 2017: exact sign handling near -z.
mat3 get_shading_space(vec3 normal) {
    float s = normal.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + normal.z);
    float b = normal.x * normal.y * a;
    vec3 tangent = vec3(1.0 + s * normal.x * normal.x * a, s * b, -s * normal.x);
    vec3 bitangent = vec3(b, s + normal.y * normal.y * a, -normal.y);
    return mat3(tangent, bitangent, normal);
}
