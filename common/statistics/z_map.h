// Where an image is too bright or too dark.
#pragma once
#include <vector>

#include "image/image.h"

namespace lab {

// How many standard errors each tile is off; positive where it is too bright. Row by row, one channel.
struct ZMap {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<double> values;
};

// Red: too bright, blue: too dark, full colour at 5 standard errors. A tile becomes `magnification` pixels
// wide and high.
Texture draw_z_map(const ZMap& map, uint32_t magnification);

}  // namespace lab
