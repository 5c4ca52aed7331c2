// What hides an engine's name hides it where it stands, and no longer.
vec3 albedo(uint i) { return materials[i].diffuse_albedo; }

vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 sum = vec3(0.0);
    for (int materials = 0; materials < 2; ++materials) sum += 0.125 * float(materials);
    {
        vec3 materials[2] = vec3[2](vec3(0.25), vec3(0.5));
        sum += materials[1] - materials[0];
        if (sum.x > 0.0) {
            float materials[1];
            materials[0] = 2.0;
            sum.y += materials[0];
        }
        sum += materials[0];
    }
    for (int i = 0, positions = 3; i < positions; ++i) sum.z += 0.5;
    vec3 positions[3] = vec3[3](positions[0], positions[1], positions[2]);
    Material materials[2] = Material[2](materials[0], materials[1]);
    sum += materials[1].diffuse_albedo + albedo(0u) + positions[1] * 0.01;
    return sum;
}
