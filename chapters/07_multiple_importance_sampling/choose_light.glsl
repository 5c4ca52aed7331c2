// Light samples choose an emissive triangle by its power, wherever x_k is.

// What a bounce needs to know about x_{k-1} to weigh the light that it finds against the light sample taken there.
struct Receiver {
    bool is_light_sampled;  // whether that light sample could have found what the ray hits
};

// The receiver of a camera ray: no light sample is taken at the camera.
const Receiver NO_RECEIVER = Receiver(false);

// The receiver x_k. No light sample meets a dielectric's directions.
Receiver get_receiver(ShadingData s) { return Receiver(STRATEGY != STRATEGY_BOUNCES && !s.is_dielectric); }

// Chooses a triangle for a light sample at x_k, and two numbers in [0,1) for a point on it.
LightTriangle choose_light(ShadingData s, inout uvec2 seed, out vec2 u) { return choose_light_triangle(seed, u); }

// p_A, the density with respect to area that the receiver's light sample has at the emissive point x_k.
float get_light_density(Receiver receiver, ShadingData s) { return s.light_density; }
