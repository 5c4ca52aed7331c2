#version 460
// Adds the samples of shared pixels, which several threads render, to the film in index order.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "blocks.glsl"
#include "film.glsl"

layout(scalar, push_constant) uniform DispatchParametersBlock { DispatchParameters dispatch; };
layout(scalar, set = 0, binding = BINDING_RENDER_PARAMETERS) uniform RenderParametersBlock {
    RenderParameters parameters;
};
layout(scalar, set = 0, binding = BINDING_FILM) buffer Film { FilmPixel film[]; };
layout(scalar, set = 0, binding = BINDING_SAMPLES) readonly buffer Samples { vec3 samples[]; };

layout(local_size_x = BLOCK_SIZE) in;

void main() {
    uint block = dispatch.first_block + gl_WorkGroupID.x;
    uvec2 position = get_pixel_position(block, gl_LocalInvocationIndex, parameters.image_size);
    if (any(greaterThanEqual(position, parameters.image_size))) return;
    uint film_index = position.y * parameters.image_size.x + position.x - dispatch.first_film_pixel;

    FilmPixel pixel = film[film_index];
    // Where render_samples.glsl has stored the pixel's next sample.
    uint place = gl_WorkGroupID.x * dispatch.samples_per_pixel * BLOCK_SIZE + gl_LocalInvocationIndex;
    for (; pixel.sample_count < dispatch.target_samples; place += BLOCK_SIZE) add_sample(pixel, samples[place]);
    film[film_index] = pixel;
}
