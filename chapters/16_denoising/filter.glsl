// A filter replaces a pixel by a weighted mean of the pixels q around it,
//   F(p) = Σ w(p,q) I(q) / Σ w(p,q)   with the variance   Σ w(p,q)² Var I(q) / (Σ w(p,q))².
// The variance falls with the number of pixels, but where neighbours show something else, there is now a bias. Both halves of the
// samples are filtered apart, each with weights of its own: so the other half can judge the result.

#ifndef FILTER
#define FILTER FILTER_NL_MEANS
#endif
#define FILTER_BILATERAL 1
#define FILTER_A_TROUS 2
#define FILTER_NL_MEANS 3

// How different the surfaces are that the camera sees in two pixels: 1 where their normals are 8° apart.
float get_feature_difference(ivec2 p, ivec2 q) {
    vec3 between = get_normal(p) - get_normal(q);
    return dot(between, between) / 0.02;
}

// How far apart the values of two pixels are beyond their noise, relative to it: 0 on average if both show the same, since the
// square of a difference is then the sum of both variances.
float get_difference(ivec2 p, ivec2 q, int half_index) {
    const float SHARPNESS = 0.45;  // differences that count, in standard deviations
    vec3 d = get_mean(p, half_index) - get_mean(q, half_index);
    vec3 v = get_variance(p, half_index), w = get_variance(q, half_index);
    vec3 relative = (d * d - (v + min(v, w))) / (SHARPNESS * SHARPNESS * (v + w) + 1e-30);
    return (relative.r + relative.g + relative.b) / 3.0;
}

#if FILTER == FILTER_BILATERAL
// Joint bilateral: close to p, and alike in what the camera sees. The noise plays no part.
const int RADIUS = 7, STEP = 1;
float get_weight(ivec2 p, ivec2 q, int half_index) {
    vec2 offset = vec2(q - p) / 4.0;
    return exp(-0.5 * dot(offset, offset) - get_feature_difference(p, q));
}
#elif FILTER == FILTER_A_TROUS
// À-trous: five passes with holes between the pixels that each looks at, and so 125 pixels instead of 3,969 (Dammertz et al. 2010).
const int RADIUS = 2;
#define STEP (1 << int(filtering.pass))
float get_weight(ivec2 p, ivec2 q, int half_index) {
    ivec2 offset = abs(q - p) / STEP;
    const float KERNEL[3] = float[](1.0, 2.0 / 3.0, 1.0 / 6.0);
    float difference = p == q ? 0.0 : max(get_difference(p, q, half_index), 0.0);
    return KERNEL[offset.x] * KERNEL[offset.y] * exp(-0.1 * difference - get_feature_difference(p, q));
}
#else
// Non-local means: what looks alike around both pixels (Buades, Coll and Morel 2005; Rousselle, Knaus and Zwicker 2012).
const int RADIUS = 3, STEP = 1, PATCH = 2;
float get_weight(ivec2 p, ivec2 q, int half_index) {
    float difference = 0.0;
    for (int y = -PATCH; y <= PATCH; ++y)
        for (int x = -PATCH; x <= PATCH; ++x) difference += get_difference(p + ivec2(x, y), q + ivec2(x, y), half_index);
    difference /= float((2 * PATCH + 1) * (2 * PATCH + 1));
    return exp(-max(max(difference, get_feature_difference(p, q)), 0.0));
}
#endif

FilterPixel filter_pixel(ivec2 p) {
    FilterPixel result;
    for (int half_index = 0; half_index < 2; ++half_index) {
        vec3 sum = vec3(0.0), variance = vec3(0.0);
        float weights = 0.0;
        for (int y = -RADIUS; y <= not_unrolled(RADIUS); ++y)
            for (int x = -RADIUS; x <= not_unrolled(RADIUS); ++x) {
                ivec2 q = p + STEP * ivec2(x, y);
                if (!is_inside(q) || !is_valid(q) && q != p) continue;
                float weight = get_weight(p, q, half_index);
                sum += weight * get_mean(q, half_index);
                variance += weight * weight * get_variance(q, half_index);
                weights += weight;
            }
        result.mean[half_index] = sum / weights;
        result.variance[half_index] = variance / (weights * weights);
    }
    return result;
}
