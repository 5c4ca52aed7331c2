// Rendering without a window: from the options to the written files.
#pragma once
#include "rendering/build.h"

namespace lab {

// Renders until the samples, the target error or the time limit are reached or Ctrl-C is pressed, then writes
// all outputs and the report and prints a summary. Throws DeviceFailure if the device is lost, after writing
// what was last read from it.
void render_headless(Build& build);

}  // namespace lab
