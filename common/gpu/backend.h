// The ways to trace rays, as rows of a table: common/app/backends.h lists them, docs/backends.md compares them.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

class SceneBackend;
class Device;
class GpuScene;
struct DeviceDescription;
struct Scene;

struct BackendRow {
    const char* name;                                      // on the command line and in reports
    std::span<const char* const> extensions = {};          // of Vulkan that it needs
    std::span<const std::string_view> special_views = {};  // views that only backends with this entry can show
    // Whether it may refuse a shader that others accept. It is then chosen by hand, or where the caller is prepared for that.
    bool may_refuse_shaders = false;
    // What else it lacks there, as --list-devices says it; null: nothing.
    std::vector<std::string> (*missing)(const DeviceDescription& device) = nullptr;
    // What its speed depends on besides device and driver, as --list-devices says it; null: nothing.
    std::string (*details)() = nullptr;
    // Whether the device has room for the scene, and it may be the fastest there; null: always.
    bool (*suits)(const Device& device, const Scene& scene) = nullptr;
    // Device and scene must outlive the result. Throws DeviceError if there is no room.
    std::unique_ptr<SceneBackend> (*build)(const Device& device, const GpuScene& scene);
};

using Backend = const BackendRow*;

inline std::string to_string(Backend backend) { return backend->name; }

}  // namespace lab
