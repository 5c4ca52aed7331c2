// The backends that the programs have. A new one is a row here, and its folder.
#pragma once
#include "native/native_backend.h"
#include "tracing/vulkan_backends.h"

namespace lab {

inline constexpr Backend all_backends[] = {pipeline_backend, query_backend, compute_backend, native_backend};

}  // namespace lab
