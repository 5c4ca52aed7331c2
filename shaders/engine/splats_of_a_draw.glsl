// Light that light paths send to pixels other than their own, where a draw cannot add it: a fragment keeps one connection of its light
// path for all of them, and add_splats.frag adds it afterwards.

layout(location = 3) out uvec4 web_splat_words;
uint web_splat_pixel = 0u;
vec3 web_splat_colour = vec3(0.0);  // of the one that is kept, with components up to 1
float web_splat_light = 0.0;        // of all

// Keeps each connection with a probability proportional to its largest component, with the light of all. So every pixel receives on
// average what it should.
void add_splat(uvec2 pixel, vec3 radiance, uint sample_index) {
    uint pixel_index = pixel.y * parameters.image_size.x + pixel.x;
    // What is negative or NaN reaches the film as infinity, and is counted there.
    if (!all(greaterThanEqual(radiance, vec3(0.0)))) radiance = vec3(uintBitsToFloat(0x7f800000u));
    float light = max_component(radiance);
    if (light == 0.0) return;
    web_splat_light += light;
    uvec2 seed = get_state(floatBitsToUint(web_splat_light), sample_index, parameters.seed_key);
    if (!happens(light / web_splat_light, seed)) return;
    web_splat_pixel = pixel_index;
    web_splat_colour = radiance / light;
}

void web_write_splat() { web_splat_words = uvec4(web_splat_pixel, floatBitsToUint(web_splat_light * web_splat_colour)); }
