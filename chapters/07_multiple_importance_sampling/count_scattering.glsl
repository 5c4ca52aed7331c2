// What to note where a path scatters light, with the radiance that it has found so far: nothing, until chapter 17 differentiates.
void count_scattering(ShadingData s, vec3 radiance) {}
