// Whether rays that miss all triangles may find light.
#if defined(FEATURE_LIGHT_PROBE) || defined(FEATURE_SKY)
const bool HAS_BACKGROUND = true;
#else
const bool HAS_BACKGROUND = false;
#endif

// Emitted radiance L_e(-ω) of what lies behind the scene, where a ray in the unit direction ω misses all triangles.
vec3 get_background_radiance(vec3 direction) {
#if defined(FEATURE_LIGHT_PROBE)
    return parameters.background * get_light_probe_radiance(direction);
#elif defined(FEATURE_SKY)
    return parameters.background;
#else
    return vec3(0.0);
#endif
}
