// Emitted radiance L_e(-ω) of what lies behind the scene, where a ray in direction ω misses all triangles.
vec3 get_background_radiance(vec3 direction) {
#if defined(FEATURE_LIGHT_PROBE)
    // Equirectangular image: +Y up, its centre towards -Z before the rotation.
    float u = 0.5 + (atan(direction.x, -direction.z) + parameters.probe_rotation) / (2.0 * PI);
    float v = acos(clamp(direction.y, -1.0, 1.0)) / PI;
    return parameters.background * textureLod(light_probe, vec2(u, v), 0.0).rgb;
#elif defined(FEATURE_SKY)
    return parameters.background;
#else
    return vec3(0.0);
#endif
}
