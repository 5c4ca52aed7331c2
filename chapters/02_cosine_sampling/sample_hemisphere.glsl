// A direction about the z-axis with density cos θ / π with respect to solid angle, for u uniform in [0,1)². Never
// horizontal: cos θ = √(1 - u_y) > 0.
vec3 sample_hemisphere(vec2 u) {
    float phi = 2.0 * PI * u.x - PI;
    float sin_theta = sqrt(u.y);
    return vec3(cos(phi) * sin_theta, sin(phi) * sin_theta, sqrt(1.0 - u.y));
}
