// How far light gets in a homogeneous medium.

// The optical depth -ln(1 - u) at which a free flight ends, for a random word of 32 bits: 24 of them, or 1 - u rounded, would make
// collisions in a thin medium too frequent, since a small u decides there. The bits of ~word are those of 1 - u.
float get_flight_depth(uint word) {
    float u = (float(word) + 0.5) / 4294967296.0;
    return u < 0.001 ? u + 0.5 * u * u : -log((float(~word) + 0.5) / 4294967296.0);
}
