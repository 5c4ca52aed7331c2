// Chapter 2: cosine sampling: directions where the light counts. The path tracer itself is path_trace.glsl.
#include "app/run_chapter.h"

int main(int argument_count, char** arguments) {
    return lab::run_chapter(
        {.name = LAB_CHAPTER, .title = "Cosine sampling: directions where the light counts"}, argument_count,
        arguments);
}
