// What is filtered: the light that surfaces scatter, for each half of the samples, with its variance.

// Albedos below this one do not divide: light that reaches a pixel some other way would become infinite.
const float ALBEDO_FLOOR = 0.05;
vec3 get_divisor(uint pixel_index) { return max(get_mean_of(get_film_pixel(FILM_ALBEDO, pixel_index)), ALBEDO_FLOOR); }

// The number of samples in a half: the first, third, … or the others.
float get_count(FilmPixel pixel, int half_index) { return float((pixel.sample_count + 1u - uint(half_index)) / 2u); }

// The sum of these samples.
vec3 get_sum(FilmPixel pixel, int half_index) {
    vec3 sum = pixel.sum + pixel.compensation;
    return 0.5 * (half_index == 0 ? sum + pixel.difference : sum - pixel.difference);
}

vec3 get_half_mean(FilmPixel pixel, int half_index) { return get_sum(pixel, half_index) / get_count(pixel, half_index); }

// A lamp is bright, sharp, and known exactly, if the same camera rays see it: its light stays out of the filter.
vec3 get_emission(uint pixel_index, int half_index) {
    return get_half_mean(get_film_pixel(FILM_EMISSION, pixel_index), half_index);
}

FilterPixel get_filter_input(uint pixel_index) {
    FilmPixel now = get_film_pixel(FILM_NOW, pixel_index), before = get_film_pixel(FILM_BEFORE, pixel_index);
    FilmPixel emission_before = get_film_pixel(FILM_EMISSION_BEFORE, pixel_index);
    vec3 divisor = get_divisor(pixel_index);
    FilterPixel result;
    for (int half_index = 0; half_index < 2; ++half_index) {
        float count = get_count(now, half_index), earlier = get_count(before, half_index), later = count - earlier;
        vec3 mean = (get_half_mean(now, half_index) - get_emission(pixel_index, half_index)) / divisor;
        vec3 earlier_mean = (get_half_mean(before, half_index) - get_half_mean(emission_before, half_index)) / divisor;
        // The earlier and the later samples of a half are independent. The square of their difference is on average the variance
        // of a sample times 1/n_1 + 1/n_2, and that of the half's mean is the variance of a sample over n_1 + n_2.
        vec3 difference = earlier_mean - (count * mean - earlier * earlier_mean) / later;
        result.mean[half_index] = mean;
        result.variance[half_index] = earlier * later / (count * count) * difference * difference;
    }
    return result;
}

// The pixel as a film holds it, from both filtered halves.
FilmPixel get_picture(uint pixel_index, FilterPixel filtered) {
    FilmPixel result = get_film_pixel(FILM_NOW, pixel_index);
    vec3 divisor = get_divisor(pixel_index);
    vec3 sums[2];
    for (int half_index = 0; half_index < 2; ++half_index)
        sums[half_index] = get_count(result, half_index) *
                           (divisor * filtered.mean[half_index] + get_emission(pixel_index, half_index));
    result.sum = sums[0] + sums[1];
    result.compensation = vec3(0.0);
    result.difference = sums[0] - sums[1];
    return result;
}
