// The program of every chapter, whose folder holds chapter.json and path_trace.glsl.
#include "app/run_chapter.h"

int main(int argument_count, char** arguments) { return lab::run_chapter(LAB_CHAPTER, argument_count, arguments); }
