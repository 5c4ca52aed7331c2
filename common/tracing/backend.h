// The ways to trace rays, as rows of a table: common/app/all_backends.h lists them, docs/backends.md compares them.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tracing/tracer.h"

namespace lab {

struct BackendRow {
    const char* name;                                      // on the command line and in reports
    std::span<const char* const> extensions = {};          // of Vulkan that it needs
    std::span<const std::string_view> special_views = {};  // views that only backends with this entry can show
    // Whether it may refuse a shader that others accept. It is then chosen by hand, or where the caller is prepared for that.
    bool may_refuse_shaders = false;
    // What else it lacks there, as --list-devices says it; null: nothing.
    std::vector<std::string> (*further_needs)(const DeviceDescription& device) = nullptr;
    // What its speed depends on besides device and driver, as --list-devices says it; null: nothing.
    std::string (*details)() = nullptr;
    // Whether the device has room for the scene, and it may be the fastest there; null: always.
    bool (*suits)(const Device& device, const Scene& scene) = nullptr;
    // Device and scene must outlive the result. Throws DeviceError if there is no room.
    std::unique_ptr<SceneBackend> (*build)(const Device& device, const GpuScene& scene);
};

using Backend = const BackendRow*;

inline std::string to_string(Backend backend) { return backend->name; }

// What a device lacks for a backend.
std::vector<std::string> missing_for(Backend backend, const DeviceDescription& device);
bool is_supported(Backend backend, const DeviceDescription& device);

// Whether the device lacks nothing for the backend, which may be the fastest one for the scene there.
bool is_suitable(Backend backend, const Device& device, const Scene& scene);

}  // namespace lab
