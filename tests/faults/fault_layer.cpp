// A Vulkan layer between program and driver that simulates a failing or smaller device, since no device fails when a test wants
// it to. FAULT_LOSE_DEVICE_AFTER=N: the device is lost after N submissions. FAULT_MEMORY_MIB=N: it has no more memory than this.
// FAULT_CARVE_OUT_MIB=N: it is an integrated GPU whose own heap has this size, and the rest is the CPU's.
// FAULT_maxImageDimension2D=N, and so on: it has this limit. The Vulkan loader finds the layer through VK_LAYER_PATH and
// VK_INSTANCE_LAYERS.
#include <vulkan/vk_layer.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <type_traits>

namespace {

PFN_vkGetInstanceProcAddr next_instance_function = nullptr;
PFN_vkGetDeviceProcAddr next_device_function = nullptr;
VkInstance instance = VK_NULL_HANDLE;  // programs under test have one instance and one device
VkDevice device = VK_NULL_HANDLE;

// The limit in an environment variable; without it, unlimited.
uint64_t limit(const char* variable) {
    const char* text = std::getenv(variable);
    return text ? std::strtoull(text, nullptr, 10) : UINT64_MAX;
}

uint64_t submissions_left = limit("FAULT_LOSE_DEVICE_AFTER");
uint64_t mebibytes_left = limit("FAULT_MEMORY_MIB");
const uint64_t carve_out_mebibytes = limit("FAULT_CARVE_OUT_MIB");
const bool is_integrated = carve_out_mebibytes != UINT64_MAX;
uint64_t own_mebibytes_left = carve_out_mebibytes;
uint64_t allocations_left = limit("FAULT_maxMemoryAllocationCount");
uint32_t driver_memory_types = 0;  // an integrated GPU repeats each of them in the CPU's heap

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(next_device_function(device, name));
}

// The next functions of the instance: once it exists, the loader returns those of the first layer.
PFN_vkGetPhysicalDeviceProperties next_get_properties = nullptr;
PFN_vkGetPhysicalDeviceProperties2 next_get_properties2 = nullptr;
PFN_vkGetPhysicalDeviceMemoryProperties next_get_memory_properties = nullptr;

void change_properties(VkPhysicalDeviceProperties& properties) {
    if (is_integrated) properties.deviceType = VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    VkPhysicalDeviceLimits& limits = properties.limits;
    const auto lower = [](uint32_t& value, const char* variable) {
        value = static_cast<uint32_t>(std::min<uint64_t>(value, limit(variable)));
    };
    lower(limits.maxImageDimension2D, "FAULT_maxImageDimension2D");
    lower(limits.maxTexelBufferElements, "FAULT_maxTexelBufferElements");
    lower(limits.maxMemoryAllocationCount, "FAULT_maxMemoryAllocationCount");
    lower(limits.maxPerStageDescriptorSampledImages, "FAULT_maxPerStageDescriptorSampledImages");
    lower(limits.maxPerStageResources, "FAULT_maxPerStageResources");
}

void VKAPI_CALL get_properties(VkPhysicalDevice physical, VkPhysicalDeviceProperties* properties) {
    next_get_properties(physical, properties);
    change_properties(*properties);
}

void VKAPI_CALL get_properties2(VkPhysicalDevice physical, VkPhysicalDeviceProperties2* properties) {
    next_get_properties2(physical, properties);
    change_properties(properties->properties);
}

void VKAPI_CALL get_memory_properties(VkPhysicalDevice physical, VkPhysicalDeviceMemoryProperties* memory) {
    next_get_memory_properties(physical, memory);
    if (!is_integrated) return;
    driver_memory_types = memory->memoryTypeCount;
    VkMemoryHeap& own = memory->memoryHeaps[0];
    memory->memoryHeaps[memory->memoryHeapCount] = {own.size - (carve_out_mebibytes << 20), 0};
    own.size = carve_out_mebibytes << 20;
    for (uint32_t type = 0; type < driver_memory_types; ++type)
        memory->memoryTypes[memory->memoryTypeCount++] = {
            memory->memoryTypes[type].propertyFlags & ~VkFlags{VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT}, memory->memoryHeapCount};
    ++memory->memoryHeapCount;
}

void VKAPI_CALL get_buffer_requirements(VkDevice of, VkBuffer buffer, VkMemoryRequirements* requirements) {
    next<PFN_vkGetBufferMemoryRequirements>("vkGetBufferMemoryRequirements")(of, buffer, requirements);
    requirements->memoryTypeBits |= requirements->memoryTypeBits << driver_memory_types;
}

void VKAPI_CALL get_image_requirements(VkDevice of, VkImage image, VkMemoryRequirements* requirements) {
    next<PFN_vkGetImageMemoryRequirements>("vkGetImageMemoryRequirements")(of, image, requirements);
    requirements->memoryTypeBits |= requirements->memoryTypeBits << driver_memory_types;
}

VkResult VKAPI_CALL queue_submit(VkQueue queue, uint32_t count, const VkSubmitInfo* submits, VkFence fence) {
    if (submissions_left == 0) return VK_ERROR_DEVICE_LOST;
    --submissions_left;
    return next<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, count, submits, fence);
}

VkResult VKAPI_CALL allocate_memory(VkDevice of, const VkMemoryAllocateInfo* info, const VkAllocationCallbacks* callbacks,
                                    VkDeviceMemory* memory) {
    const uint64_t mebibytes = info->allocationSize >> 20;
    if (mebibytes > mebibytes_left) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    if (allocations_left == 0) return VK_ERROR_TOO_MANY_OBJECTS;
    VkMemoryAllocateInfo of_driver = *info;
    if (is_integrated && info->memoryTypeIndex >= driver_memory_types) {
        of_driver.memoryTypeIndex -= driver_memory_types;
    } else if (is_integrated) {
        if (mebibytes > own_mebibytes_left) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
        own_mebibytes_left -= mebibytes;
    }
    mebibytes_left -= mebibytes;
    --allocations_left;
    return next<PFN_vkAllocateMemory>("vkAllocateMemory")(of, &of_driver, callbacks, memory);
}

void VKAPI_CALL free_memory(VkDevice of, VkDeviceMemory memory, const VkAllocationCallbacks* callbacks) {
    if (memory) ++allocations_left;
    next<PFN_vkFreeMemory>("vkFreeMemory")(of, memory, callbacks);
}

// The loader's link to the next layer or the driver; it is removed from the chain for those that follow.
template <typename Info, VkStructureType type, typename CreateInfo>
auto take_link(const CreateInfo* create) {
    auto* info = static_cast<Info*>(const_cast<void*>(create->pNext));
    while (info->sType != type || info->function != VK_LAYER_LINK_INFO) info = static_cast<Info*>(const_cast<void*>(info->pNext));
    auto* link = info->u.pLayerInfo;
    info->u.pLayerInfo = link->pNext;
    return link;
}

VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* callbacks,
                                    VkInstance* created) {
    next_instance_function =
        take_link<VkLayerInstanceCreateInfo, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO>(info)->pfnNextGetInstanceProcAddr;
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(next_instance_function(VK_NULL_HANDLE, "vkCreateInstance"));
    const VkResult result = create(info, callbacks, created);
    if (result != VK_SUCCESS) return result;
    instance = *created;
    const auto take_next = [](auto& function, const char* name) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(next_instance_function(instance, name));
    };
    take_next(next_get_properties, "vkGetPhysicalDeviceProperties");
    take_next(next_get_properties2, "vkGetPhysicalDeviceProperties2");
    take_next(next_get_memory_properties, "vkGetPhysicalDeviceMemoryProperties");
    return result;
}

VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                  const VkAllocationCallbacks* callbacks, VkDevice* created) {
    next_device_function =
        take_link<VkLayerDeviceCreateInfo, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO>(info)->pfnNextGetDeviceProcAddr;
    const auto create = reinterpret_cast<PFN_vkCreateDevice>(next_instance_function(instance, "vkCreateDevice"));
    const VkResult result = create(physical, info, callbacks, created);
    if (result == VK_SUCCESS) device = *created;
    return result;
}

PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice of, const char* name) {
    if (!std::strcmp(name, "vkGetDeviceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(device_function);
    if (!std::strcmp(name, "vkQueueSubmit")) return reinterpret_cast<PFN_vkVoidFunction>(queue_submit);
    if (!std::strcmp(name, "vkAllocateMemory")) return reinterpret_cast<PFN_vkVoidFunction>(allocate_memory);
    if (!std::strcmp(name, "vkFreeMemory")) return reinterpret_cast<PFN_vkVoidFunction>(free_memory);
    if (!std::strcmp(name, "vkGetBufferMemoryRequirements")) return reinterpret_cast<PFN_vkVoidFunction>(get_buffer_requirements);
    if (!std::strcmp(name, "vkGetImageMemoryRequirements")) return reinterpret_cast<PFN_vkVoidFunction>(get_image_requirements);
    return next_device_function(of, name);
}

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance of, const char* name) {
    if (!std::strcmp(name, "vkGetInstanceProcAddr")) return reinterpret_cast<PFN_vkVoidFunction>(instance_function);
    if (!std::strcmp(name, "vkCreateInstance")) return reinterpret_cast<PFN_vkVoidFunction>(create_instance);
    if (!std::strcmp(name, "vkCreateDevice")) return reinterpret_cast<PFN_vkVoidFunction>(create_device);
    if (!std::strcmp(name, "vkGetPhysicalDeviceProperties")) return reinterpret_cast<PFN_vkVoidFunction>(get_properties);
    if (!std::strcmp(name, "vkGetPhysicalDeviceProperties2")) return reinterpret_cast<PFN_vkVoidFunction>(get_properties2);
    if (!std::strcmp(name, "vkGetPhysicalDeviceMemoryProperties"))
        return reinterpret_cast<PFN_vkVoidFunction>(get_memory_properties);
    return next_instance_function(of, name);
}

}  // namespace

// Negotiation between the loader and the layer.
extern "C" __attribute__((visibility("default"))) VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
    version->pfnGetInstanceProcAddr = instance_function;
    version->pfnGetDeviceProcAddr = device_function;
    version->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
