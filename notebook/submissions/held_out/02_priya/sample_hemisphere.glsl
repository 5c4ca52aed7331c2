// Malley's method: a uniform point on the unit disk, lifted to the hemisphere. The disk is covered by the concentric mapping
// of Shirley and Chiu (1997), which keeps neighbouring points of the square neighbours on the disk.
vec2 square_to_disk(vec2 u) {
    vec2 p = 2.0 * u - 1.0;
    if (p == vec2(0.0)) return vec2(0.0);
    float radius, angle;
    if (abs(p.x) > abs(p.y)) {
        radius = p.x;
        angle = (PI / 4.0) * (p.y / p.x);
    } else {
        radius = p.y;
        angle = (PI / 2.0) - (PI / 4.0) * (p.x / p.y);
    }
    return radius * vec2(cos(angle), sin(angle));
}

vec3 sample_hemisphere(vec2 u) {
    vec2 d = square_to_disk(u);
    return vec3(d, sqrt(max(1.0 - dot(d, d), 0.0)));
}
