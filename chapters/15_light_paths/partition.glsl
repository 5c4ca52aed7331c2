// Who finds which light. Light paths find what meets smooth glass first, and leaves it for a surface that the camera sees. Camera
// paths leave exactly these out, so no light counts twice, and none is lost.

// Whether the camera's path starts at something other than smooth glass, once it has left x_1.
bool starts_matte = false;

// Whether a bounce from the receiver counts the lamps that it hits. Behind glass no light sample is taken.
bool counts_lamps(Receiver receiver) { return receiver.is_light_sampled || !starts_matte; }
