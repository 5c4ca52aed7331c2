// Runs a chapter as a complete program.
#pragma once
#include <string>

namespace lab {

struct Build;

// The whole program of the chapter in this folder of chapters/: reads the command line, renders, writes.
// Returns the exit code: 0 done, 1 bad input or usage, 2 no usable device, 3 device lost or out of memory.
int run_chapter(const std::string& chapter, int argument_count, char** arguments);

// Renders until the samples, the target error or the time limit are reached or Ctrl-C is pressed, then writes
// all outputs and the report and prints a summary. Throws DeviceFailure if the device is lost, after writing
// what was last read from it.
void render_headless(Build& build);

}  // namespace lab
