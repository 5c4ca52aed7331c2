// Chapter 6: dielectrics: reflection and refraction by glass. The path tracer itself is path_trace.glsl.
#include "app/run_chapter.h"

int main(int argument_count, char** arguments) {
    return lab::run_chapter({.name = LAB_CHAPTER,
                             .title = "Dielectrics: reflection and refraction by glass",
                             .default_scene = "glass",
                             .light_sampling = true,
                             .unlimited_path_length = true,
                             .dielectrics = true,
                             .options = {lab::splitting_factor, lab::survival_cap, lab::roulette_start}},
                            argument_count, arguments);
}
