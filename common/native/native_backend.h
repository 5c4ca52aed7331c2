// The `native` backend: the shaders of `compute` as C++ on the CPU. Embree traces the rays where it is installed.
#pragma once
#include "tracing/backend.h"

namespace lab {

extern const BackendRow native_row;
inline constexpr Backend native_backend = &native_row;

}  // namespace lab
