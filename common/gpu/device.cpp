#include "gpu/device.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>
#include <system_error>

#include "clock.h"
#include "error.h"
#include "files/cache.h"
#include "files/file.h"
#include "platform.h"

namespace lab {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

std::string version_text(uint32_t version) {
    return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
           std::to_string(VK_API_VERSION_PATCH(version));
}

std::string kind_text(vk::PhysicalDeviceType type) {
    static const std::map<vk::PhysicalDeviceType, std::string> kinds{{vk::PhysicalDeviceType::eDiscreteGpu, "discrete GPU"},
                                                                     {vk::PhysicalDeviceType::eIntegratedGpu, "integrated GPU"},
                                                                     {vk::PhysicalDeviceType::eVirtualGpu, "virtual GPU"},
                                                                     {vk::PhysicalDeviceType::eCpu, "CPU"}};
    const auto found = kinds.find(type);
    return found == kinds.end() ? "other" : found->second;
}

bool contains(const std::vector<vk::ExtensionProperties>& extensions, std::string_view name) {
    return std::ranges::any_of(extensions, [&](const auto& extension) { return extension.extensionName.data() == name; });
}

// Enabled where the device has them.
constexpr const char* tracing_extensions[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                              VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
                                              VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME, VK_KHR_RAY_QUERY_EXTENSION_NAME};

// Required features; those for ray tracing count only with their extensions.
using Features = vk::StructureChain<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceVulkan12Features,
                                    vk::PhysicalDeviceAccelerationStructureFeaturesKHR,
                                    vk::PhysicalDeviceRayTracingPipelineFeaturesKHR, vk::PhysicalDeviceRayQueryFeaturesKHR>;

bool computes(const vk::QueueFamilyProperties& family) {
    return family.queueFlags & vk::QueueFlagBits::eCompute && family.timestampValidBits > 0;
}

std::vector<std::string> missing_features(const vk::raii::PhysicalDevice& device, const Features& features) {
    std::vector<std::string> missing;
    const auto& vulkan12 = features.get<vk::PhysicalDeviceVulkan12Features>();
    if (!vulkan12.scalarBlockLayout) missing.emplace_back("scalarBlockLayout");
    if (!vulkan12.shaderSampledImageArrayNonUniformIndexing) missing.emplace_back("shaderSampledImageArrayNonUniformIndexing");
    if (std::ranges::none_of(device.getQueueFamilyProperties(), computes))
        missing.emplace_back("a compute queue with timestamps");
    return missing;
}

// Bytes of all heaps, or only of the device-local ones if it does not share the CPU's memory.
size_t usable_memory(const vk::raii::PhysicalDevice& device, bool shares_memory) {
    const auto memory = device.getMemoryProperties();
    size_t sum = 0;
    for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
        if (shares_memory || memory.memoryHeaps[i].flags & vk::MemoryHeapFlagBits::eDeviceLocal)
            sum += memory.memoryHeaps[i].size;
    return sum;
}

DeviceDescription describe(const vk::raii::PhysicalDevice& device) {
    const auto properties = device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties,
                                                  vk::PhysicalDeviceMaintenance3Properties>();
    const auto& general = properties.get<vk::PhysicalDeviceProperties2>().properties;
    const auto& driver = properties.get<vk::PhysicalDeviceDriverProperties>();
    const bool shares_memory =
        general.deviceType == vk::PhysicalDeviceType::eIntegratedGpu || general.deviceType == vk::PhysicalDeviceType::eCpu;
    DeviceDescription description{
        .name = general.deviceName.data(),
        .kind = kind_text(general.deviceType),
        .driver = driver.driverName.data() + std::string(driver.driverInfo[0] ? " " : "") + driver.driverInfo.data(),
        .api_version = version_text(general.apiVersion),
        .shares_memory = shares_memory,
        .memory = usable_memory(device, shares_memory),
        // Offsets of parts are 32-bit.
        .largest_buffer =
            std::min<size_t>(properties.get<vk::PhysicalDeviceMaintenance3Properties>().maxMemoryAllocationSize, UINT32_MAX),
        .missing = {},
        .extensions = {},
    };
    if (general.apiVersion < VK_API_VERSION_1_2) {
        description.missing = {"Vulkan 1.2"};
        return description;
    }
    Features features;
    device.getDispatcher()->vkGetPhysicalDeviceFeatures2(*device, reinterpret_cast<VkPhysicalDeviceFeatures2*>(&features.get()));
    description.missing = missing_features(device, features);
    for (const auto& extension : device.enumerateDeviceExtensionProperties())
        description.extensions.insert(extension.extensionName.data());
    if (!features.get<vk::PhysicalDeviceVulkan12Features>().bufferDeviceAddress)
        description.extensions.erase(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
    return description;
}

// What to do without a driver. Variables may hide those that are installed.
std::string driver_advice() {
    for (const char* name : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_LOADER_DRIVERS_SELECT", "VK_LOADER_DRIVERS_DISABLE"})
        if (const char* value = std::getenv(name))
            return std::string("the variable ") + name + " is " + in_quotes(value) + ": unset it, or correct it";
    return std::string("install ") + vulkan_driver;
}

vk::raii::Instance create_instance(const vk::raii::Context& context, bool validation, std::vector<const char*> extensions = {}) {
    const vk::ApplicationInfo application("path tracing lab", 1, nullptr, 0, VK_API_VERSION_1_2);
    std::vector<const char*> layers;
    if (validation) {
        const auto available = context.enumerateInstanceLayerProperties();
        if (std::none_of(available.begin(), available.end(),
                         [](const vk::LayerProperties& layer) { return std::strcmp(layer.layerName, validation_layer) == 0; }))
            throw DeviceError("the Vulkan validation layer is not installed: install vulkan-validationlayers");
        layers.push_back(validation_layer);
        extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    }
    // Incomplete implementations such as macOS's are listed only on request.
    vk::InstanceCreateFlags flags;
    if (contains(context.enumerateInstanceExtensionProperties(), VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME)) {
        extensions.push_back(VK_KHR_PORTABILITY_ENUMERATION_EXTENSION_NAME);
        flags = vk::InstanceCreateFlagBits::eEnumeratePortabilityKHR;
    }
    try {
        return {context, vk::InstanceCreateInfo(flags, &application, layers, extensions)};
    } catch (const vk::SystemError&) {
        throw DeviceError("no Vulkan driver: " + driver_advice());
    }
}

vk::raii::Context load_vulkan() {
    try {
        return {};
    } catch (const std::exception&) {
        throw DeviceError(std::string("Vulkan is missing: install ") + vulkan_driver);
    }
}

std::vector<vk::raii::PhysicalDevice> enumerate_devices(const vk::raii::Instance& instance) {
    std::vector<vk::raii::PhysicalDevice> devices;
    try {
        for (auto& device : vk::raii::PhysicalDevices(instance)) devices.push_back(std::move(device));
    } catch (const vk::SystemError&) {
    }
    if (devices.empty()) throw DeviceError("no Vulkan device: " + driver_advice());
    return devices;
}

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

// Index of the chosen device: by number, by its name or a part that no other name has, or the first usable one of the fastest
// kind.
size_t choose_device(const std::vector<DeviceDescription>& devices, const std::string& choice) {
    if (choice.empty()) {
        for (const char* kind : {"discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"})
            for (size_t i = 0; i < devices.size(); ++i)
                if (devices[i].kind == kind && devices[i].missing.empty()) return i;
        return 0;
    }
    const bool is_number = choice.size() < 6 && choice.find_first_not_of("0123456789") == std::string::npos;
    if (is_number && std::stoul(choice) < devices.size()) return std::stoul(choice);
    std::vector<size_t> named, similar;
    for (size_t i = 0; i < devices.size(); ++i) {
        const size_t place = lower_case(devices[i].name).find(lower_case(choice));
        if (place == std::string::npos) continue;
        similar.push_back(i);
        if (devices[i].name.size() == choice.size()) named.push_back(i);
    }
    const auto& found = named.empty() ? similar : named;
    if (found.size() == 1) return found.front();
    if (found.empty())
        throw DeviceError("no device '" + choice + "': --list-devices shows the " + std::to_string(devices.size()) +
                          " there are");
    throw DeviceError("--device " + choice + " may be '" + devices[found[0]].name + "' or '" + devices[found[1]].name +
                      "': choose by number, such as --device " + std::to_string(found[0]) + " (see --list-devices)");
}

}  // namespace

Device::Device(const DeviceOptions& options)
    : context_(load_vulkan()), instance_(create_instance(context_, options.validation, options.instance_extensions)) {
    if (options.validation) {
        // The C structure: Vulkan-Hpp changed the callback's parameter types between releases.
        VkDebugUtilsMessengerCreateInfoEXT info{};
        info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
        info.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
        info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
        info.pfnUserCallback = receive_message;
        info.pUserData = &messages_;
        messenger_ = {instance_, vk::DebugUtilsMessengerCreateInfoEXT(info)};
    }
    auto devices = enumerate_devices(instance_);
    std::vector<DeviceDescription> descriptions;
    for (const auto& device : devices) descriptions.push_back(describe(device));
    const size_t chosen = choose_device(descriptions, options.choice);
    description_ = descriptions[chosen];
    if (!description_.missing.empty())
        throw DeviceError("device '" + description_.name + "' lacks " + description_.missing.front() +
                          ": choose another with --device (see --list-devices) or update its driver");
    physical_ = std::move(devices[chosen]);
    limits_ = physical_.getProperties().limits;
    if (options.make_surface) surface_ = {instance_, options.make_surface(*instance_)};
    choose_queue_family();
    create_device();
    load_pipeline_cache();
}

void Device::choose_queue_family() {
    const auto families = physical_.getQueueFamilyProperties();
    if (*surface_) {
        const bool has_swapchain = description_.extensions.contains(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
        for (uint32_t family = 0; has_swapchain && family < families.size(); ++family)
            if (computes(families[family]) && families[family].queueFlags & vk::QueueFlagBits::eGraphics &&
                physical_.getSurfaceSupportKHR(family, *surface_)) {
                queue_family_ = family;
                return;
            }
        surface_ = nullptr;
    }
    while (!computes(families[queue_family_])) ++queue_family_;
}

void Device::create_device() {
    const auto families = physical_.getQueueFamilyProperties();
    const uint32_t timestamp_bits = families[queue_family_].timestampValidBits;
    timestamp_mask_ = timestamp_bits < 64 ? (uint64_t{1} << timestamp_bits) - 1 : ~uint64_t{0};
    const float priority = 1;
    const vk::DeviceQueueCreateInfo queue({}, queue_family_, 1, &priority);
    Features features;
    auto& vulkan12 = features.get<vk::PhysicalDeviceVulkan12Features>();
    vulkan12.scalarBlockLayout = true;
    vulkan12.shaderSampledImageArrayNonUniformIndexing = true;
    if (description_.extensions.contains(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME))
        for (const char* extension : tracing_extensions)
            if (description_.extensions.contains(extension)) extensions_.insert(extension);
    if (*surface_) extensions_.insert(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    constexpr const char* portability = "VK_KHR_portability_subset";  // must be enabled if a device has it
    if (description_.extensions.contains(portability)) extensions_.insert(portability);
    const auto switch_on = [&]<typename Structure>(vk::Bool32 Structure::*feature, const char* extension) {
        features.get<Structure>().*feature = true;
        if (!has_extension(extension)) features.unlink<Structure>();
    };
    vulkan12.bufferDeviceAddress = has_extension(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
    switch_on(&vk::PhysicalDeviceAccelerationStructureFeaturesKHR::accelerationStructure,
              VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
    switch_on(&vk::PhysicalDeviceRayTracingPipelineFeaturesKHR::rayTracingPipeline, VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME);
    switch_on(&vk::PhysicalDeviceRayQueryFeaturesKHR::rayQuery, VK_KHR_RAY_QUERY_EXTENSION_NAME);

    std::vector<const char*> names;
    for (const auto& extension : extensions_) names.push_back(extension.c_str());
    vk::DeviceCreateInfo info({}, queue, {}, names);
    info.pNext = &features.get();
    device_ = {physical_, info};
    queue_ = device_.getQueue(queue_family_, 0);
    command_pool_ = {device_, {vk::CommandPoolCreateFlagBits::eResetCommandBuffer, queue_family_}};
    command_buffer_ = std::move(vk::raii::CommandBuffers(device_, {*command_pool_, vk::CommandBufferLevel::ePrimary, 1})[0]);
    fence_ = {device_, vk::FenceCreateInfo()};
    timestamps_ = {device_, vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, 2)};
}

void Device::wait_for_fence(double patience) const {
    constexpr uint64_t nanoseconds = 50'000'000;  // between two looks for an interrupt
    std::optional<Clock::time_point> interrupted;
    while (device_.waitForFences(*fence_, true, nanoseconds) == vk::Result::eTimeout) {
        if (!interrupted && is_interrupted()) interrupted = Clock::now();
        if (interrupted && seconds_since(*interrupted) > patience)
            throw EndlessWork("the device did not answer within " + std::to_string(std::lround(patience)) +
                              " s: it is busy, or a loop of the shader does not end");
    }
}

double Device::submit(const std::function<void(const vk::raii::CommandBuffer&)>& record, double patience) const {
    const auto lock = lock_queue();
    command_buffer_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    command_buffer_.resetQueryPool(*timestamps_, 0, 2);
    wait_for_writes(command_buffer_);  // by earlier submissions
    command_buffer_.writeTimestamp(vk::PipelineStageFlagBits::eTopOfPipe, *timestamps_, 0);
    record(command_buffer_);
    command_buffer_.writeTimestamp(vk::PipelineStageFlagBits::eBottomOfPipe, *timestamps_, 1);
    // Make the device's writes visible to the host.
    command_buffer_.pipelineBarrier(vk::PipelineStageFlagBits::eAllCommands, vk::PipelineStageFlagBits::eHost, {},
                                    vk::MemoryBarrier(vk::AccessFlagBits::eMemoryWrite, vk::AccessFlagBits::eHostRead), {}, {});
    command_buffer_.end();
    queue_.submit(vk::SubmitInfo({}, {}, *command_buffer_), *fence_);
    wait_for_fence(patience);
    device_.resetFences(*fence_);
    const auto [result, ticks] = timestamps_.getResults<uint64_t>(0, 2, 2 * sizeof(uint64_t), sizeof(uint64_t),
                                                                  vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    return static_cast<double>((ticks[1] - ticks[0]) & timestamp_mask_) * static_cast<double>(limits_.timestampPeriod) * 1e-9;
}

VkBool32 Device::receive_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT type,
                                 const VkDebugUtilsMessengerCallbackDataEXT* data, void* messages) {
    auto& received = *static_cast<Messages*>(messages);
    const std::lock_guard lock(received.mutex);
    // Loader and driver send 'general' messages; the layers send 'validation' and 'performance'.
    auto& list = type == VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT ? received.driver : received.validation;
    list.emplace_back(data->pMessage);
    return VK_FALSE;
}

// The name distinguishes devices; the driver itself rejects a pipeline cache that is not its own.
static std::string pipeline_cache_name(const vk::raii::PhysicalDevice& device) {
    const auto properties = device.getProperties();
    const std::string_view uuid(reinterpret_cast<const char*>(properties.pipelineCacheUUID.data()), VK_UUID_SIZE);
    return cache_name("pipelines", uuid);
}

void Device::load_pipeline_cache() {
    const auto cached = read_cache(pipeline_cache_name(physical_)).value_or("");
    pipeline_cache_ = {device_, vk::PipelineCacheCreateInfo({}, cached.size(), cached.data())};
    pipeline_cache_size_ = cached.size();
}

std::shared_ptr<const Pipeline> Device::share_pipeline(const std::string& key, const std::function<Pipeline()>& make) const {
    const std::lock_guard lock(pipelines_mutex_);
    if (const auto found = pipelines_.find(key); found != pipelines_.end()) return found->second;
    constexpr size_t most = 64;  // a window that watches its shader makes a new one after each edit
    if (pipelines_.size() == most) pipelines_.clear();
    return pipelines_[key] = std::make_shared<const Pipeline>(make());
}

Device::~Device() {
    try {
        const auto contents = pipeline_cache_.getData();
        if (contents.size() != pipeline_cache_size_)
            write_cache(pipeline_cache_name(physical_), {reinterpret_cast<const char*>(contents.data()), contents.size()});
    } catch (const vk::SystemError&) {
        // A lost device has no pipelines to save.
    }
}

void wait_for_writes(const vk::raii::CommandBuffer& commands) {
    const auto all = vk::PipelineStageFlagBits::eAllCommands;
    commands.pipelineBarrier(
        all, all, {},
        vk::MemoryBarrier(vk::AccessFlagBits::eMemoryWrite, vk::AccessFlagBits::eMemoryRead | vk::AccessFlagBits::eMemoryWrite),
        {}, {});
}

std::vector<DeviceDescription> list_devices() {
    const vk::raii::Context context = load_vulkan();
    const vk::raii::Instance instance = create_instance(context, false);
    std::vector<DeviceDescription> descriptions;
    for (const auto& device : enumerate_devices(instance)) descriptions.push_back(describe(device));
    return descriptions;
}

Failure failure_of(const std::exception& error) {
    if (dynamic_cast<const DeviceError*>(&error)) return {2, error.what()};
    if (dynamic_cast<const DeviceFailure*>(&error)) return {3, error.what()};
    if (dynamic_cast<const vk::SystemError*>(&error)) return {3, std::string("the device failed: ") + error.what()};
    if (const auto* system = dynamic_cast<const std::system_error*>(&error);
        system && system->code() == std::errc::resource_unavailable_try_again)
        return {3, "no room for another thread: raise the limit of memory (ulimit -v) or of processes (ulimit -u)"};
    if (dynamic_cast<const std::bad_alloc*>(&error)) return {3, "out of memory: use a smaller scene or image"};
    return {1, error.what()};
}

}  // namespace lab
