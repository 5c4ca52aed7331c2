// Runs a chapter as a complete program.
#pragma once
#include <string>

namespace lab {

// The whole program of the chapter in this folder of chapters/: reads the command line, renders, writes.
// Returns the exit code: 0 done, 1 bad input or usage, 2 no usable device, 3 device lost or out of memory.
int run_chapter(const std::string& chapter, int argument_count, char** arguments);

}  // namespace lab
