// What the preprocessor leaves out is not read: quotes, other alphabets, brackets and unknown directives. A \ joins lines, even \
within a word: don't { read this. And ## joins words.
#if 0
    don't (größer) } ] ) { [ (   // it's /* no comment
    don’t read this line, which is joined \
#endif
#foo's
#error don't
#endif
#ifdef UNDEFINED
    it's "all right" { \ $ @ `
#endif
/* don't { */
#define UNUSED größer, don't {
#def\
ine FACTOR 0.5
#define JOIN(a, b) a##b
#define JOIN_EXPANDED(a, b) JOIN(a, b)
#define VECTOR(n) vec ## n
#define MEMBER(name) film.sample_##name
#define TWO 2
#define SAMPLES samples##_of
#define samples 7

struct Weights {
    float sample_count, sample_weight;
};

vec3 path_trace(Ray ray, inout uvec2 seed) {
    Weights film;
    MEMBER(count) = 4.0;
    MEMBER(weight) = FAC\
TOR;
    float xTWO = 1.0, x2 = 8.0, SAMPLES = 3.0;
    x2 JOIN(+, =) xTWO; /\
/ don't
    x2 -\
= 2.0;
    VECTOR(3) JOIN(sum, _) = VECTOR(3)(JOIN(x, TWO), JOIN_EXPANDED(x, TWO), samples_of);
    return sum_ * MEMBER(count) * MEMBER(weight);
}
#undef samples
