float triangle_materials_at(int i) { return float(i); }
vec3 path_trace(Ray ray, inout uvec2 seed) { uint i = triangle_materials[3], j = triangle_materials[triangle_materials[0] + 1u]; vec3 e[2]; e[0] = materials[i].emission; e[1][2] = float(j); return e[0] + e[1] + triangle_materials_at(3); }
