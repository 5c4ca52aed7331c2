// Chapter 3: next event estimation: a point on the lights at every hit. The path tracer itself is
// path_trace.glsl.
#include "app/run_chapter.h"

int main(int argument_count, char** arguments) {
    return lab::run_chapter({.name = LAB_CHAPTER,
                             .title = "Next event estimation: a point on the lights at every hit",
                             .light_sampling = true},
                            argument_count, arguments);
}
