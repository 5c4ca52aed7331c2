// How fast renderers are, measured so that they can be compared.
#pragma once
#include <vector>

#include "app/all_backends.h"
#include "rendering/renderer.h"

namespace lab {

// Per second on the device.
struct Rates {
    double paths_per_second;
    double rays_per_second;
};

// Runs of about `seconds` each, by the renderers in turns, so that other load on the machine affects all of them alike. Returns
// the runs of each renderer in order, without the first one, which warms up.
std::vector<std::vector<Rates>> measure_in_turns(const std::vector<Renderer*>& renderers, double seconds, uint32_t runs = 5);

// The median of an odd number of runs.
Rates median(std::vector<Rates> runs);

}  // namespace lab
