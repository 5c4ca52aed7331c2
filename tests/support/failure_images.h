// Pictures of a failed image comparison, for people to look at.
#pragma once
#include <string>

#include "statistics/live_verdict.h"

namespace lab {

// Writes image, reference and their difference (EXR) and the map of z-values (PNG: red is too bright, blue too dark, saturated at
// 5 standard errors) to output/failed/TEST.WHAT, and prints that folder.
void write_failure(const std::string& what, const Image& image, const Image& reference, const ZMap& map);

// How many expectations of the running test have failed.
int failed_expectations();

}  // namespace lab
