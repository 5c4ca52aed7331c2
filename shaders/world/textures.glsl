// Images of the scene, filtered linearly. The weights are computed here, since samplers round them to 1/256, each device in its
// own way, and all devices and backends should give the same image.

// The four texels around a point of an image and the weights of the right and the lower ones.
struct TexelNeighbours {
    ivec2 upper_left;
    ivec2 lower_right;
    vec2 weights;
};

// `uv` is (0,0) at the upper left corner, (1,1) at the lower right. The image repeats in u; in v it repeats or ends.
TexelNeighbours get_texel_neighbours(vec2 uv, ivec2 size, bool repeat_v) {
    uv.x -= floor(uv.x);
    uv.y = repeat_v ? uv.y - floor(uv.y) : clamp(uv.y, 0.0, 1.0);
    vec2 position = uv * vec2(size) - 0.5;
    TexelNeighbours texels;
    ivec2 corner = ivec2(floor(position));
    texels.weights = position - vec2(corner);
    texels.upper_left = corner;
    texels.lower_right = corner + 1;
    if (corner.x < 0) texels.upper_left.x = size.x - 1;
    if (corner.x + 1 >= size.x) texels.lower_right.x = 0;
    if (corner.y < 0) texels.upper_left.y = repeat_v ? size.y - 1 : 0;
    if (corner.y + 1 >= size.y) texels.lower_right.y = repeat_v ? 0 : size.y - 1;
    return texels;
}

vec3 mix_texels(vec4 upper_left, vec4 upper_right, vec4 lower_left, vec4 lower_right, vec2 weights) {
    return mix(mix(upper_left, upper_right, weights.x), mix(lower_left, lower_right, weights.x), weights.y).rgb;
}

#ifdef FEATURE_TEXTURES
// Linear colour of a texel that is encoded as sRGB (IEC 61966-2-1). Samplers decode it, too, but on one of the devices that we
// measured only to 8 bits.
vec4 fetch_colour(int index, ivec2 texel) {
    vec3 encoded = texelFetch(textures[nonuniformEXT(index)], texel, 0).rgb;
    vec3 curved = pow((encoded + 0.055) / 1.055, vec3(2.4));
    return vec4(mix(curved, encoded / 12.92, lessThanEqual(encoded, vec3(0.04045))), 1.0);
}

// Linear colour of a texture. Its size does not come from textureSize(): where the threads of a group use different textures, one
// driver returns the same size to all of them.
vec3 get_texture_colour(int index, vec2 uv) {
    TexelNeighbours t = get_texel_neighbours(uv, ivec2(texture_sizes[index]), true);
    return mix_texels(fetch_colour(index, t.upper_left),
                      fetch_colour(index, ivec2(t.lower_right.x, t.upper_left.y)),
                      fetch_colour(index, ivec2(t.upper_left.x, t.lower_right.y)),
                      fetch_colour(index, t.lower_right), t.weights);
}
#endif
