#version 460
// Writes consecutive numbers to all fields of all structs that C++ and GLSL share, in the host's order.
#extension GL_EXT_scalar_block_layout : require
#include "interface.h"
#include "all_structs.h"

layout(scalar, binding = 0) writeonly buffer Results { AllStructs results[]; };

uint counter = 0u;
uint next() { return ++counter; }
vec3 next_vec3() {
    float x = next(), y = next(), z = next();
    return vec3(x, y, z);
}
uvec2 next_uvec2() {
    uint x = next(), y = next();
    return uvec2(x, y);
}

Camera next_camera() {
    Camera camera;
    camera.position = next_vec3();
    camera.forward = next_vec3();
    camera.right = next_vec3();
    camera.up = next_vec3();
    return camera;
}

layout(local_size_x = 128) in;

void main() {
    if (gl_GlobalInvocationID.x > 0) return;
    for (int i = 0; i < 2; ++i) {
        results[0].materials[i].diffuse_albedo = next_vec3();
        results[0].materials[i].albedo_texture = int(next());
        results[0].materials[i].emission = next_vec3();
        results[0].materials[i].specular_exponent = next();
        results[0].materials[i].specular_albedo = next_vec3();
        results[0].materials[i].refractive_index = next();
        results[0].materials[i].absorption = next_vec3();
        for (int column = 0; column < 4; ++column) results[0].instances[i].object_to_world[column] = next_vec3();
        for (int column = 0; column < 3; ++column) results[0].instances[i].normal_to_world[column] = next_vec3();
        results[0].cameras[i] = next_camera();
        results[0].render_parameters[i].camera = next_camera();
        results[0].render_parameters[i].image_size = next_uvec2();
        results[0].render_parameters[i].seed_key = next_uvec2();
        results[0].render_parameters[i].first_sample = next();
        results[0].render_parameters[i].max_path_length = next();
        results[0].render_parameters[i].only_path_length = -int(next());
        results[0].render_parameters[i].background = next_vec3();
        results[0].render_parameters[i].probe_rotation = next();
        results[0].dispatch_parameters[i].first_block = next();
        results[0].dispatch_parameters[i].threads_per_pixel = next();
        results[0].dispatch_parameters[i].samples_per_pixel = next();
        results[0].dispatch_parameters[i].target_samples = next();
        results[0].dispatch_parameters[i].first_film_pixel = next();
        results[0].film_pixels[i].sum = next_vec3();
        results[0].film_pixels[i].compensation = next_vec3();
        results[0].film_pixels[i].difference = next_vec3();
        results[0].film_pixels[i].sample_count = next();
        results[0].film_pixels[i].invalid_count = next();
    }
}
