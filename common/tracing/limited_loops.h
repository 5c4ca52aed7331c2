// Ends the loops of an estimator that would never end: no one can interrupt a shader on a device.
#pragma once
#include <cstdint>
#include <string>

#include "error.h"
#include "tracing/tracer.h"

namespace lab {

// A loop of the shader went on for so long that it was ended. The samples of that dispatch are wrong.
struct StuckLoop : UserError {
    using UserError::UserError;
};

// The estimator whose loops end after more iterations than a right one needs, see shaders/engine/limited_loops.glsl. Its samples
// stay the same. Loops in shaders/ are left as they are.
Estimator with_limited_loops(Estimator estimator);

// Inserts calls of is_loop_stuck() into the loops of an expanded shader, in files outside of shaders/. Lines keep their numbers.
std::string limit_loops(const std::string& text);

// Size of the ray counters with what follows them, in bytes.
constexpr size_t ray_counters_size = (RAY_COUNTER_COUNT + 1) * sizeof(uint32_t);

// Call this after a dispatch. Throws StuckLoop, naming the place in the estimator's files, if one of its loops had to be ended.
void check_loops(std::span<const uint32_t> ray_counters, const Estimator& estimator);

}  // namespace lab
