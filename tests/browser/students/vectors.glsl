// Vectors with an index, which the engine has in its own way, and swizzles.
vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 result = vec3(0.0);
    for (int k = 0; k < 3; ++k) {
        ray.direction[k] = 0.25 * float(k + 1);
        ray.origin[(k + 1) % 3] = float(k);
    }
    uvec4 children = uvec4(1u, 2u, 3u, 4u);
    for (uint k = 0u; k < 4u; ++k) children[k] += k;
    uvec4 chosen = uvec4(7u);
    result.xz = ray.direction.yx;
    result[1] += float(children[3u & 2u]);
    result.zy[1] += ray.origin[0];
    mat3 film = mat3(1.0);
    film[1] = vec3(0.5);
    film[2][1] = 3.0;
    return film * result + vec3(chosen.xyz) * 0.125;
}
