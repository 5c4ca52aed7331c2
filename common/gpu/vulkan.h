// Vulkan-Hpp's RAII handles. Precompiled; include it only where a declaration needs it.
#pragma once
#define VULKAN_HPP_DISPATCH_LOADER_DYNAMIC 1
#include <vulkan/vulkan_raii.hpp>
