#version 460
// Tone-maps a film for the screen, as to_display() in common/film/film_image.cpp does on the CPU, within one step of 8 bits.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "blocks.glsl"

layout(scalar, push_constant) uniform DisplayParametersBlock { DisplayParameters display; };
layout(scalar, set = 0, binding = BINDING_FILM) readonly buffer Film { FilmPixel film[]; };
layout(set = 0, binding = BINDING_PICTURE, rgba8) writeonly uniform image2D picture;
// The bits of the largest value: as integers, those of non-negative floats are ordered like the floats.
layout(scalar, set = 0, binding = BINDING_LARGEST_VALUE) buffer LargestValue { uint largest_value; };

#ifdef SPLATS
layout(scalar, set = 0, binding = BINDING_SPLATS) readonly buffer Splats { uint splats[]; };

// Adds the light that light paths sent to a pixel.
void add_splats(inout FilmPixel pixel, uint index) {
    uint word = SPLAT_WORDS * index;
    for (uint i = 0u; i < 6u; ++i, word += 2u)
        pixel.sum[i % 3u] += display.splat_unit * (float(splats[word]) + 4294967296.0 * float(splats[word + 1u]));
    pixel.invalid_count += splats[word];
}
#endif

layout(local_size_x = BLOCK_SIZE) in;

vec3 get_srgb(vec3 linear) {
    return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, greaterThan(linear, vec3(0.0031308)));
}

// Derivatives may be negative. Such pixels are blue.
vec3 get_shown(vec3 value) {
    float sum = value.r + value.g + value.b;
    return sum < 0.0 ? vec3(0.0, 0.0, -sum / 3.0) : value;
}

void show_pixel(uvec2 position) {
    if (any(greaterThanEqual(position, display.image_size))) return;
    uvec2 film_position = position * display.film_size / display.image_size;
    uint film_index = film_position.y * display.film_size.x + film_position.x - display.first_film_pixel;
    if (film_index >= film.length()) return;  // outside the bound part of a large film; before it, the index has wrapped around
    FilmPixel pixel = film[film_index];
    // Until the new picture has a sample here, the previous one stays.
    if (pixel.sample_count == 0u) return;
#ifdef SPLATS
    add_splats(pixel, film_index + display.first_film_pixel);
#endif
    vec3 radiance = get_shown((pixel.sum + pixel.compensation) / float(pixel.sample_count));

    if (display.divides_by_largest == 2u) {
        float largest = max(max(radiance.r, radiance.g), max(radiance.b, 0.0));
        atomicMax(largest_value, floatBitsToUint(largest));
        return;
    }
    float scale = display.scale;
    if (display.divides_by_largest == 1u && largest_value != 0u) scale /= uintBitsToFloat(largest_value);
    vec3 colour = clamp(scale * radiance, 0.0, 1.0);
    if (display.is_srgb != 0u) colour = get_srgb(colour);
    if (pixel.invalid_count > 0u) colour = vec3(1.0, 0.0, 1.0);
    imageStore(picture, ivec2(position), vec4(colour, 1.0));
}

void main() {
    // A device may allow fewer workgroups than a large picture has blocks.
    for (uint block = gl_WorkGroupID.x; block < display.block_count; block += gl_NumWorkGroups.x)
        show_pixel(get_pixel_position(block, gl_LocalInvocationIndex, display.image_size));
}
