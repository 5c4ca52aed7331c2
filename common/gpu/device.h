// A Vulkan device with one queue, for compute and optionally a window, and its validation messages.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "error.h"
#include "gpu/vulkan.h"

namespace lab {

struct DeviceOptions {
    std::string choice;       // index or part of a name in --list-devices; empty: the fastest kind
    bool validation = false;  // needs the validation layer to be installed
    // Instance extensions that the window needs; empty without a window.
    std::vector<const char*> instance_extensions = {};
    std::function<VkSurfaceKHR(VkInstance)> make_surface = {};
};

// A device as --list-devices shows it.
struct DeviceDescription {
    std::string name;
    std::string kind;    // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
    std::string driver;  // name and version
    std::string api_version;
    bool shares_memory = false;                     // with the CPU
    size_t memory = 0;                              // bytes that shaders can use
    size_t largest_buffer = 0;                      // bytes of a buffer that is bound part by part
    std::vector<std::string> missing;               // features that all shaders need and the device lacks
    std::set<std::string, std::less<>> extensions;  // that the device has, those for tracing rays only where they work
};

// A compiled pipeline, and the layout that it needs.
struct Pipeline {
    vk::raii::PipelineLayout layout = nullptr;
    vk::raii::Pipeline handle = nullptr;
};

class Device {
  public:
    // Throws DeviceError without a driver (saying what to install), without such a device, or if it lacks a feature.
    explicit Device(const DeviceOptions& options);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    const vk::raii::Device& handle() const { return device_; }
    const vk::raii::PhysicalDevice& physical() const { return physical_; }
    const vk::raii::PipelineCache& pipeline_cache() const { return pipeline_cache_; }
    // A pipeline that was made for the same `key` before, or else what `make` returns. The key holds all that it depends on. Any
    // thread may call this.
    std::shared_ptr<const Pipeline> share_pipeline(const std::string& key, const std::function<Pipeline()>& make) const;
    const DeviceDescription& description() const { return description_; }
    const vk::PhysicalDeviceLimits& limits() const { return limits_; }
    // Properties from an extension's own structure.
    template <typename Properties>
    Properties properties() const {
        return physical_.getProperties2<vk::PhysicalDeviceProperties2, Properties>().template get<Properties>();
    }
    bool has_extension(const char* name) const { return extensions_.contains(name); }

    // For windows. The surface is null if the device cannot present to it.
    const vk::raii::Instance& instance() const { return instance_; }
    const vk::raii::SurfaceKHR& surface() const { return surface_; }
    const vk::raii::Queue& queue() const { return queue_; }
    uint32_t queue_family() const { return queue_family_; }
    // Hold this lock while using queue(). submit() takes it itself and may be called from any thread.
    std::unique_lock<std::mutex> lock_queue() const { return std::unique_lock(queue_mutex_); }

    // Records and submits commands, waits for them, and returns the seconds they took on the device. Throws EndlessWork if they
    // do not end within `patience` seconds after an interrupt (see platform.h).
    double submit(const std::function<void(const vk::raii::CommandBuffer&)>& record, double patience = 3) const;

    // Messages so far from the validation layers and the driver; empty without validation.
    const std::vector<std::string>& validation_messages() const { return messages_.validation; }
    const std::vector<std::string>& driver_messages() const { return messages_.driver; }

  private:
    struct Messages {
        std::vector<std::string> validation;
        std::vector<std::string> driver;
        std::mutex mutex;  // any thread may add messages
    };
    static VkBool32 receive_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT type,
                                    const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages);
    void wait_for_fence(double patience) const;
    void choose_queue_family();
    void create_device();
    void load_pipeline_cache();

    Messages messages_;
    vk::raii::Context context_;
    vk::raii::Instance instance_ = nullptr;
    vk::raii::DebugUtilsMessengerEXT messenger_ = nullptr;
    vk::raii::SurfaceKHR surface_ = nullptr;
    vk::raii::PhysicalDevice physical_ = nullptr;
    DeviceDescription description_;
    vk::PhysicalDeviceLimits limits_;
    std::set<std::string, std::less<>> extensions_;
    uint32_t queue_family_ = 0;
    uint64_t timestamp_mask_ = 0;  // the counter's valid bits
    vk::raii::Device device_ = nullptr;
    vk::raii::Queue queue_ = nullptr;
    mutable std::mutex queue_mutex_;
    vk::raii::CommandPool command_pool_ = nullptr;
    vk::raii::CommandBuffer command_buffer_ = nullptr;
    vk::raii::Fence fence_ = nullptr;
    vk::raii::QueryPool timestamps_ = nullptr;
    vk::raii::PipelineCache pipeline_cache_ = nullptr;
    size_t pipeline_cache_size_ = 0;
    mutable std::mutex pipelines_mutex_;
    mutable std::map<std::string, std::shared_ptr<const Pipeline>> pipelines_;  // by key
};

// A full memory barrier: later commands see, and may overwrite, everything written before.
void wait_for_writes(const vk::raii::CommandBuffer& commands);

// All devices in the order of their indices. Throws DeviceError without a Vulkan driver.
std::vector<DeviceDescription> list_devices();

// A shader goes on although it was interrupted. Nothing that it uses can be destroyed any more.
struct EndlessWork : DeviceFailure {
    using DeviceFailure::DeviceFailure;
};

// What an exception means to the user of a program or window.
struct Failure {
    int exit_code;        // as error.h says
    std::string message;  // one line
};
Failure failure_of(const std::exception& error);

}  // namespace lab
