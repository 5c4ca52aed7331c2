// Each sample of the view runs a few samples of one camera ray in the chapter's own loop, and returns the idle fraction of
// that time.
const uint OBSERVED_SAMPLES = 16u;

Ray observed_ray;
uvec2 observed_seed;

Ray start_observed_sample(uvec2 position, uint index, out uvec2 seed) {
    seed = random_start_state(observed_seed.x, index, observed_seed);
    return observed_ray;
}
void drop_sample(vec3 radiance) {}

#define render_samples render_observed_samples
#define start_sample start_observed_sample
#define finish_sample drop_sample
#include "observed_sample_loop.glsl"
#undef render_samples
#undef start_sample
#undef finish_sample

void render_samples(uvec2 position, uint first, uint end, uint step) {
    for (uint i = first; i < end; i += step) {
        observed_ray = start_sample(position, i, observed_seed);
        own_steps = group_steps = 0u;
        render_observed_samples(position, 0u, OBSERVED_SAMPLES, 1u);
        uint steps = subgroupAdd(group_steps);
        finish_sample(vec3(float(steps - own_steps) / float(steps)));  // subtracting first keeps it from falling below 0
    }
}
