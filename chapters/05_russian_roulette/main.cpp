// Chapter 5: Russian roulette: dim paths end early, without bias. The path tracer itself is path_trace.glsl.
#include "app/run_chapter.h"

int main(int argument_count, char** arguments) {
    return lab::run_chapter({.name = LAB_CHAPTER,
                             .title = "Russian roulette: dim paths end early, without bias",
                             .light_sampling = true,
                             .split_every_hit = true,
                             .unlimited_path_length = true,
                             .options = {lab::splitting_factor, lab::survival_cap, lab::roulette_start}},
                            argument_count, arguments);
}
