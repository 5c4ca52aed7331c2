// How the light of a path depends on the albedo ρ of one material.
//
// A path that the material has scattered k times brings light in proportion to ρ^k. The derivative with respect to ln ρ is that
// light times k, since ∂ρ^k / ∂ln ρ = k ρ^k. So a path adds its light once for every time that the material scattered it.

// The material's index in the scene, 0u for the first one: --derivative sets it.
#ifndef DERIVATIVE
#define DERIVATIVE NO_MATERIAL
#endif

float scattering_count = 0.0;  // how often the material has scattered this path's light
vec3 radiance_before = vec3(0.0);  // what the path had found before each of these times, added up

void start_counting() {
    scattering_count = 0.0;
    radiance_before = vec3(0.0);
}

// Notes that the path scatters at x_k, after finding this radiance.
void count_scattering(ShadingData s, vec3 radiance) {
    if (s.material != DERIVATIVE) return;
    scattering_count += 1.0;
    radiance_before += radiance;
}

// ∂L / ∂ln ρ of a path that has found this radiance: each scattering counts all light that was found after it.
vec3 get_derivative(vec3 radiance) { return scattering_count * radiance - radiance_before; }
