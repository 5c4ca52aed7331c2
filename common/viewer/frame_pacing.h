// Divides the time of a frame between rendering and the user interface.
#pragma once
#include <algorithm>

namespace lab {

// Seconds of a frame that rendering may take, after frames that took `interface_seconds` for everything else
// but waiting. A fast device fills what is left of the display's period. Where the interface itself is slow,
// as on a CPU, a frame takes longer than a period, so that most of the time goes into the picture, but not so
// long that there are fewer than 5 frames a second, while the interface leaves that choice.
inline double rendering_seconds(double refresh_seconds, double interface_seconds) {
    constexpr double slowest_frame = 0.16;  // leaves some room for blocks that take longer than expected
    constexpr double shortest = 0.002;
    const double frame =
        std::clamp(4 * interface_seconds, refresh_seconds, std::max(refresh_seconds, slowest_frame));
    return std::max(frame - interface_seconds, shortest);
}

}  // namespace lab
