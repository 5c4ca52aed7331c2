// cosine-weighted hemisphere (Malley): point on disk -> project up
vec3 sample_hemisphere(vec2 u) {
    // uniform on the disk
    float r = sqrt(u.x);
    float phi = 2.0 * PI * u.y;
    vec2 disk = r * vec2(cos(phi), sin(phi));

    // up to the sphere
    float z = 1.0 - dot(disk, disk);
    return normalize(vec3(disk, z));
}
