// The chapter's own loop over samples, with a record of where the sample starts and what it brings. A chapter with light paths starts a
// sample twice: for the path from the lamp, and then for the one from the camera.
Ray record_and_start_sample(uvec2 position, uint index, out uvec2 seed) {
    uint pixel = position.y * parameters.image_size.x + position.x;
    is_recording = pixel == recorded_pixel && parameters.first_sample + index == recorded_sample;
    record_value(EVENT_START, vec3(0.0), 0u);
    return start_sample(position, index, seed);
}

void record_and_finish_sample(vec3 radiance) {
    record_value(EVENT_RESULT, radiance, 0u);
    if (is_recording) add_shading_data();
    is_recording = false;
    finish_sample(radiance);
}

#define start_sample record_and_start_sample
#define finish_sample record_and_finish_sample
#include "observed_sample_loop.glsl"
