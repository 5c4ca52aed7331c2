void accumulate(inout vec3 film[2], uint samples, const in vec3 value) { film[samples % 2u] += value; }
vec3 path_trace(Ray ray, inout uvec2 seed) { vec3 film[2] = vec3[2](vec3(0.0), vec3(0.0)); uint samples = 0u; while (samples < 5u) { accumulate(film, samples, vec3(float(samples), 1.0, 0.5)); samples++; } return film[0] * 2.0 + film[1]; }
