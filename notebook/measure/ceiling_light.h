// The rectangular light of the benchmark's box, for its shader and for the scene.
const vec3 LIGHT_CORNER = vec3(-0.25f, 0.99f, -0.25f);
const vec3 LIGHT_EDGE_1 = vec3(0.5f, 0.0f, 0.0f);
const vec3 LIGHT_EDGE_2 = vec3(0.0f, 0.0f, 0.5f);
const vec3 LIGHT_NORMAL = vec3(0.0f, -1.0f, 0.0f);
const float LIGHT_AREA = 0.25f;
const vec3 LIGHT_RADIANCE = vec3(17.0f, 12.0f, 4.0f);

// A path survives with the probability of its throughput, but at most this.
const float SURVIVAL_CAP = 0.95f;
