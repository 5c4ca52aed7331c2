// The cells of a light probe, for light samples.
#pragma once
#include <vector>

#include "image/image.h"
#include "shaders/interface.h"

namespace lab {

// Cells row by row from the top, one a texel (larger ones where MAX_PROBE_CELL_COLUMNS or _ROWS is exceeded),
// chosen with probability proportional to the mean luminance of the filtered probe times the solid angle. So
// each cell in which anything shines has a positive probability. A black probe has uniform directions.
// `probability`: that a light sample goes to the probe at all; the densities hold it.
std::vector<ProbeCell> build_probe_table(const Image& probe, double probability = 1);

}  // namespace lab
