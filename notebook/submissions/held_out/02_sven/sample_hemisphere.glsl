// The unit normal plus a uniform point of the unit sphere points in a direction with density cos / pi. Half angles avoid a
// normalisation: if the point has the inclination t, the sum has t/2.
vec3 sample_hemisphere(vec2 u) {
    float z = 2.0 * u.x - 1.0;
    float cos_half = sqrt(0.5 * (1.0 - z)), sin_half = sqrt(max(0.5 * (1.0 + z), 0.0));
    float angle = 2.0 * PI * u.y;
    return vec3(sin_half * sin(angle), sin_half * cos(angle), cos_half);
}
