// What is left of an image comparison that failed, for people to look at.
#pragma once
#include <string>

#include "statistics/live_verdict.h"

namespace lab {

// Writes output/failed/NAME, named after the test and what of it failed: image, reference and their
// difference as EXR and PNG, the z-map (red: too bright, blue: too dark, full colour at 5 standard errors)
// and the histogram of its p-values (20 bars; even ones are good) as PNG. Prints the folder.
void write_failure(const std::string& what, const Image& image, const Image& reference, const ZMap& map);

// How many expectations of the running test have failed.
int failed_expectations();

}  // namespace lab
