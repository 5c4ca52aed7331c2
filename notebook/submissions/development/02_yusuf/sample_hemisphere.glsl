// Malley's method with Shirley and Chiu's map of the square onto the disk: a uniform point on the unit disk, projected up to the
// hemisphere, has the density cos(theta) / pi.
vec2 square_to_disk(vec2 u) {
    vec2 p = 2.0 * u - vec2(1.0);
    if (p.x == 0.0 && p.y == 0.0) return vec2(0.0);
    float radius, angle;
    if (abs(p.x) > abs(p.y)) {
        radius = p.x;
        angle = (PI / 4.0) * (p.y / p.x);
    } else {
        radius = p.y;
        angle = PI / 2.0 - (PI / 4.0) * (p.x / p.y);
    }
    return radius * vec2(cos(angle), sin(angle));
}

vec3 sample_hemisphere(vec2 u) {
    vec2 d = square_to_disk(u);
    return vec3(d, sqrt(max(1.0 - dot(d, d), 1e-8)));
}
