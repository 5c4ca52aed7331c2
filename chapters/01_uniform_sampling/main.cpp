// Chapter 1: uniform sampling of inclination and azimuth. The path tracer itself is path_trace.glsl.
#include "app/run_chapter.h"

int main(int argument_count, char** arguments) {
    return lab::run_chapter({.name = LAB_CHAPTER, .title = "Uniform sampling: the path tracer of the slides"},
                            argument_count, arguments);
}
