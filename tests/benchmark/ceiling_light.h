// The rectangular light of the benchmark's box, for the shader and for its native twin.
const vec3 LIGHT_CORNER = vec3(-0.25, 0.99, -0.25);
const vec3 LIGHT_EDGE_1 = vec3(0.5, 0.0, 0.0);
const vec3 LIGHT_EDGE_2 = vec3(0.0, 0.0, 0.5);
const vec3 LIGHT_NORMAL = vec3(0.0, -1.0, 0.0);
const float LIGHT_AREA = 0.25;
const vec3 LIGHT_RADIANCE = vec3(17.0, 12.0, 4.0);

// A path survives with the probability of its throughput, at most this.
const float SURVIVAL_CAP = 0.95;
