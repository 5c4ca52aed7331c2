// Chapter 4: splitting: several branches from the first hit. The path tracer itself is path_trace.glsl.
#include "app/run_chapter.h"

int main(int argument_count, char** arguments) {
    return lab::run_chapter({.name = LAB_CHAPTER,
                             .title = "Splitting: several branches from the first hit",
                             .light_sampling = true,
                             .split_every_hit = true,
                             .options = {lab::splitting_factor}},
                            argument_count, arguments);
}
