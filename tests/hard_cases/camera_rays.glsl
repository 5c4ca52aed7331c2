// Shows the direction of the camera ray.
vec3 path_trace(Ray ray, inout uvec2 seed) { return ray.direction; }
