// The complete program of a chapter.
#pragma once
#include <string>

namespace lab {

struct Build;

// Runs the program of a chapter (a folder of chapters/). Returns the exit code: 0 done, 1 bad input or usage, 2 no usable device,
// 3 device lost or out of memory.
int run_chapter(const std::string& chapter, int argument_count, char** arguments);

// Renders without a window until samples, target error or time limit are reached or Ctrl-C is pressed. Writes outputs and report
// and prints a summary. If the device is lost, writes the last snapshot and throws DeviceFailure.
void render_headless(Build& build);

}  // namespace lab
