vec3 my_ray() { float positions[2]; positions[0] = 1.0; positions[1] = 2.0; return vec3(positions[1]); }
