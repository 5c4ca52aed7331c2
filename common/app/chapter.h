// A chapter is a name and a shader; this runs it as a complete program.
#pragma once
#include <string>

namespace lab {

struct Chapter {
    std::string name;                           // of its folder, "01_uniform_sampling"
    std::string title;                          // shown by --help
    std::string default_scene = "cornell_box";  // in assets/scenes
    bool dielectrics = false;                   // whether its estimator handles them
};

// The whole program: reads the command line, renders, writes. Returns the exit code: 0 done, 1 bad input or
// usage, 2 no usable device, 3 device lost or out of memory.
int run_chapter(const Chapter& chapter, int argument_count, char** arguments);

}  // namespace lab
