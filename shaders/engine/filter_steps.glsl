// The steps in which a picture is filtered after its render with a chapter's filter.glsl. All pixels finish a step before the next.
// Before this file stand `FilterParameters filtering` and what reads the memory of a device:
//   FilmPixel get_film_pixel(uint film, uint pixel_index) of a film, for example FILM_NOW
//   vec3 get_mean_at(uint pixel_index, int half_index) and get_variance_at(…), as the last step has left them

// Whether the picture has such a pixel.
bool is_inside(ivec2 p) { return all(greaterThanEqual(p, ivec2(0))) && all(lessThan(p, ivec2(filtering.image_size))); }

// The index of a pixel, or outside of the picture of the one next to it.
uint get_pixel_index(ivec2 p) {
    uvec2 inside = uvec2(clamp(p, ivec2(0), ivec2(filtering.image_size) - 1));
    return inside.y * filtering.image_size.x + inside.x;
}

// What a half of a pixel's samples, 0 or 1, shows: its mean, as the last pass has left it.
vec3 get_mean(ivec2 p, int half_index) { return get_mean_at(get_pixel_index(p), half_index); }
// The variance of that mean.
vec3 get_variance(ivec2 p, int half_index) { return get_variance_at(get_pixel_index(p), half_index); }

// What all samples of a pixel show.
vec3 get_mean_of(FilmPixel pixel) { return (pixel.sum + pixel.compensation) / float(max(pixel.sample_count, 1u)); }

// The diffuse albedo that the camera rays of a pixel see, on average, also through smooth glass.
vec3 get_albedo(ivec2 p) { return get_mean_of(get_film_pixel(FILM_ALBEDO, get_pixel_index(p))); }
// The mean of the shading normals that they see, shorter than 1 where these differ.
vec3 get_normal(ivec2 p) { return 2.0 * get_mean_of(get_film_pixel(FILM_NORMALS, get_pixel_index(p))) - 1.0; }

// Samples that were infinite or not a number add 0: such a pixel is too dark, and must not darken others.
bool is_valid(ivec2 p) { return get_film_pixel(FILM_NOW, get_pixel_index(p)).invalid_count == 0u; }

// The same number, since no picture is 2^31 pixels wide. But compilers do not know it: Mesa's for CPUs would unroll the loops over
// neighbours, and compile for seven seconds instead of one.
int not_unrolled(int count) { return count + int(filtering.image_size.x >> 31); }

// FilterPixel get_filter_input(uint pixel_index), FilmPixel get_picture(uint pixel_index, FilterPixel filtered)
#include "filter_input.glsl"
// FilterPixel filter_pixel(ivec2 p)
#include "filter.glsl"

// A pixel as the last step has left it.
FilterPixel get_filter_pixel(ivec2 p) {
    FilterPixel result;
    for (int half_index = 0; half_index < 2; ++half_index) {
        result.mean[half_index] = get_mean(p, half_index);
        result.variance[half_index] = get_variance(p, half_index);
    }
    return result;
}

// The pixels around p that tell its variance.
const int NEIGHBOUR_COUNT = 5 * 5;
ivec2 get_neighbour(ivec2 p, int i) { return p + ivec2(i % 5, i / 5) - 2; }

// How bright most of them are: the geometric mean, which a few bright spots hardly change, of values that are not quite 0.
vec3 get_typical_brightness(ivec2 p, int half_index) {
    vec3 mean = vec3(0.0), logarithm = vec3(0.0);
    for (int i = 0; i < not_unrolled(NEIGHBOUR_COUNT); ++i)
        mean += abs(get_mean(get_neighbour(p, i), half_index)) / float(NEIGHBOUR_COUNT);
    vec3 least = 1e-3 * mean + 1e-30;
    for (int i = 0; i < not_unrolled(NEIGHBOUR_COUNT); ++i)
        logarithm += log(abs(get_mean(get_neighbour(p, i), half_index)) + least) / float(NEIGHBOUR_COUNT);
    return exp(logarithm);
}

// The variance of a pixel comes from a single difference, and is as uncertain as that. Neighbours help, unless one is the image of a
// lamp in a dark surface: its variance would excuse any difference around it, and the lamp became a blot. So nothing counts with more
// variance than it would have if it were 400 times as bright as what surrounds it.
FilterPixel smooth_variance(ivec2 p) {
    FilterPixel result = get_filter_pixel(p);
    for (int half_index = 0; half_index < 2; ++half_index) {
        vec3 limit = 400.0 * get_typical_brightness(p, half_index), sum = vec3(0.0);
        for (int i = 0; i < not_unrolled(NEIGHBOUR_COUNT); ++i) {
            ivec2 q = get_neighbour(p, i);
            vec3 excess = get_mean(q, half_index) / limit;
            sum += get_variance(q, half_index) / max(excess * excess, 1.0);
        }
        result.variance[half_index] = sum / float(NEIGHBOUR_COUNT);
    }
    return result;
}

// What a step before the last makes of a pixel. The last one is make_picture().
FilterPixel run_step(ivec2 p) {
    if (filtering.step == FILTER_STEP_INPUT) return get_filter_input(get_pixel_index(p));
    if (filtering.step == FILTER_STEP_SMOOTH) return smooth_variance(p);
    return filter_pixel(p);
}
FilmPixel make_picture(ivec2 p) {
    FilmPixel pixel = get_picture(get_pixel_index(p), get_filter_pixel(p));
    // A filter may divide by 0. What it makes then is counted and shown like samples that are no numbers.
    for (int channel = 0; channel < 3; ++channel)
        if (is_invalid(pixel.sum[channel]) || is_invalid(pixel.difference[channel]))
            return FilmPixel(vec3(0.0), vec3(0.0), vec3(0.0), pixel.sample_count, pixel.sample_count);
    return pixel;
}
