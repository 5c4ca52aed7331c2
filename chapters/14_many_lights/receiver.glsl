// The point x_k at which light arrives. Its light sample depends on where it is, and so does the weight of the bounce that follows.
struct Receiver {
    bool is_light_sampled;
    vec3 position;
    vec3 normal;  // light arrives from its side only, or from everywhere if it is 0
};

// The receiver of a camera ray: no light sample is taken at the camera.
const Receiver NO_RECEIVER = Receiver(false, vec3(0.0), vec3(0.0));

// The receiver x_k that follows x_{k-1}. No light sample meets a dielectric's directions. A medium has no normal.
Receiver get_receiver(Receiver before, ShadingData s) {
    Receiver receiver = Receiver(STRATEGY != STRATEGY_BOUNCES && !s.is_dielectric, s.position, s.normal);
#ifdef FEATURE_MICROFACETS
    if (s.is_rough_dielectric) receiver.normal = vec3(0.0);
#endif
    return receiver;
}

// Whether a bounce from there counts the lamps that it hits.
bool counts_lamps(Receiver receiver) { return true; }
