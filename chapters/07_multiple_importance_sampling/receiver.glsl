// What a bounce needs to know about x_{k-1} to weigh the light that it finds against the light sample taken there.
struct Receiver {
    bool is_light_sampled;  // whether that light sample could have found what the ray hits
};

// The receiver of a camera ray: no light sample is taken at the camera.
const Receiver NO_RECEIVER = Receiver(false);

// The receiver x_k that follows x_{k-1}. No light sample meets a dielectric's directions.
Receiver get_receiver(Receiver before, ShadingData s) { return Receiver(STRATEGY != STRATEGY_BOUNCES && !s.is_dielectric); }

// Whether a bounce from there counts the lamps that it hits.
bool counts_lamps(Receiver receiver) { return true; }
