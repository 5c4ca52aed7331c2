// The program of every chapter: chapter.json in its folder says what it is, path_trace.glsl is the path
// tracer.
#include "app/run_chapter.h"

int main(int argument_count, char** arguments) {
    return lab::run_chapter(LAB_CHAPTER, argument_count, arguments);
}
