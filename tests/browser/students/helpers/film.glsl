vec3 get_film() { return vec3(0.25, 0.5, 1.0); }
