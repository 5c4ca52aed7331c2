#define LOOP_BEGIN for (int i = 0; i < 3; ++i) {
#define LOOP_END }
#define ONE_MORE(x) x += 1.0
vec3 path_trace(Ray ray, inout uvec2 seed) { vec3 v = vec3(0.0); LOOP_BEGIN v[i] += float(i); if (i == 1) continue; ONE_MORE(v.x); LOOP_END return v; }
