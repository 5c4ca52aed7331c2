// The BRDF ρ(x, ω_i, ω_o) of an opaque surface, per steradian and colour channel, for unit directions that point away from it.
vec3 get_brdf(ShadingData s, vec3 in_direction) { return get_lobes_brdf(s, in_direction); }
