// How fast renderers are, measured so that they can be compared.
#pragma once
#include <vector>

#include "rendering/renderer.h"

namespace lab {

// Per second of the device.
struct Rates {
    double paths_per_second;
    double rays_per_second;
};

// Runs of about `seconds` each, which the renderers do in turns: what else the machine does meanwhile hits
// all of them alike. For each renderer its runs in order, without a first one that warms up.
std::vector<std::vector<Rates>> measure_in_turns(const std::vector<Renderer*>& renderers, double seconds, uint32_t runs = 5);

// Of an odd number of runs.
Rates median(std::vector<Rates> runs);

}  // namespace lab
