// What is left of an image comparison that failed, for people to look at.
#pragma once
#include <string>
#include <vector>

#include "image/image.h"

namespace lab {

// How many standard errors each tile is off; positive where it is too bright. Row by row, one channel.
struct ZMap {
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<double> values;
};

// Writes output/failed/NAME, named after the test and what of it failed: image, reference and their
// difference as EXR and PNG, the z-map (red: too bright, blue: too dark, full colour at 5 standard errors)
// and the histogram of its p-values (20 bars; even ones are good) as PNG. Prints the folder.
void write_failure(const std::string& what, const Image& image, const Image& reference, const ZMap& map);

// How many expectations of the running test have failed.
int failed_expectations();

}  // namespace lab
