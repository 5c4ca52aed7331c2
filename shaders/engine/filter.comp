#version 460
// Filters a picture in the programs, see filter_steps.glsl.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "blocks.glsl"
#include "film.glsl"

layout(scalar, push_constant) uniform FilterParametersBlock { FilterParameters filtering; };
layout(scalar, set = 0, binding = BINDING_FILTER_FILMS) readonly buffer Films { FilmPixel pixels[]; } films[FILTER_FILM_COUNT];
layout(scalar, set = 0, binding = BINDING_FILTER_INPUT) readonly buffer FilterInput { FilterPixel filter_input[]; };
layout(scalar, set = 0, binding = BINDING_FILTER_OUTPUT) writeonly buffer FilterOutput { FilterPixel filter_output[]; };
layout(scalar, set = 0, binding = BINDING_FILM) writeonly buffer Film { FilmPixel filtered_film[]; };

FilmPixel get_film_pixel(uint film, uint pixel_index) { return films[film].pixels[pixel_index]; }
vec3 get_mean_at(uint pixel_index, int half_index) { return filter_input[pixel_index].mean[half_index]; }
vec3 get_variance_at(uint pixel_index, int half_index) { return filter_input[pixel_index].variance[half_index]; }

#include "filter_steps.glsl"

layout(local_size_x = BLOCK_SIZE) in;

void main() {
    uvec2 position = get_pixel_position(filtering.first_block + gl_WorkGroupID.x, gl_LocalInvocationIndex, filtering.image_size);
    if (any(greaterThanEqual(position, filtering.image_size))) return;
    ivec2 p = ivec2(position);
    if (filtering.step == FILTER_STEP_PICTURE)
        filtered_film[get_pixel_index(p)] = make_picture(p);
    else
        filter_output[get_pixel_index(p)] = run_step(p);
}
