// A Vulkan layer between program and driver that makes a device fail: no device fails when a test wants it
// to. FAULT_LOSE_DEVICE_AFTER=N: the device is lost after N submissions. FAULT_MEMORY_MIB=N: it has no more
// memory than that. The Vulkan loader finds the layer through VK_LAYER_PATH and VK_INSTANCE_LAYERS.
#include <vulkan/vk_layer.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace {

PFN_vkGetInstanceProcAddr next_instance_function = nullptr;
PFN_vkGetDeviceProcAddr next_device_function = nullptr;
VkInstance instance = VK_NULL_HANDLE;  // programs under test have one instance and one device
VkDevice device = VK_NULL_HANDLE;

// What an environment variable allows; without it everything.
uint64_t limit(const char* variable) {
    const char* text = std::getenv(variable);
    return text ? std::strtoull(text, nullptr, 10) : UINT64_MAX;
}

uint64_t submissions_left = limit("FAULT_LOSE_DEVICE_AFTER");
uint64_t mebibytes_left = limit("FAULT_MEMORY_MIB");

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(next_device_function(device, name));
}

VkResult VKAPI_CALL queue_submit(VkQueue queue, uint32_t count, const VkSubmitInfo* submits, VkFence fence) {
    if (submissions_left == 0) return VK_ERROR_DEVICE_LOST;
    --submissions_left;
    return next<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, count, submits, fence);
}

VkResult VKAPI_CALL allocate_memory(VkDevice of, const VkMemoryAllocateInfo* info,
                                    const VkAllocationCallbacks* callbacks, VkDeviceMemory* memory) {
    const uint64_t mebibytes = info->allocationSize >> 20;
    if (mebibytes > mebibytes_left) return VK_ERROR_OUT_OF_DEVICE_MEMORY;
    mebibytes_left -= mebibytes;
    return next<PFN_vkAllocateMemory>("vkAllocateMemory")(of, info, callbacks, memory);
}

// The loader's link to the next layer or the driver, which is taken off the chain for those that follow.
template <typename Info, VkStructureType type, typename CreateInfo>
auto take_link(const CreateInfo* create) {
    auto* info = static_cast<Info*>(const_cast<void*>(create->pNext));
    while (info->sType != type || info->function != VK_LAYER_LINK_INFO)
        info = static_cast<Info*>(const_cast<void*>(info->pNext));
    auto* link = info->u.pLayerInfo;
    info->u.pLayerInfo = link->pNext;
    return link;
}

VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* callbacks,
                                    VkInstance* created) {
    next_instance_function =
        take_link<VkLayerInstanceCreateInfo, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO>(info)
            ->pfnNextGetInstanceProcAddr;
    const auto create =
        reinterpret_cast<PFN_vkCreateInstance>(next_instance_function(VK_NULL_HANDLE, "vkCreateInstance"));
    const VkResult result = create(info, callbacks, created);
    if (result == VK_SUCCESS) instance = *created;
    return result;
}

VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                  const VkAllocationCallbacks* callbacks, VkDevice* created) {
    next_device_function =
        take_link<VkLayerDeviceCreateInfo, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO>(info)
            ->pfnNextGetDeviceProcAddr;
    const auto create =
        reinterpret_cast<PFN_vkCreateDevice>(next_instance_function(instance, "vkCreateDevice"));
    const VkResult result = create(physical, info, callbacks, created);
    if (result == VK_SUCCESS) device = *created;
    return result;
}

PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice of, const char* name) {
    if (!std::strcmp(name, "vkGetDeviceProcAddr"))
        return reinterpret_cast<PFN_vkVoidFunction>(device_function);
    if (!std::strcmp(name, "vkQueueSubmit")) return reinterpret_cast<PFN_vkVoidFunction>(queue_submit);
    if (!std::strcmp(name, "vkAllocateMemory")) return reinterpret_cast<PFN_vkVoidFunction>(allocate_memory);
    return next_device_function(of, name);
}

PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance of, const char* name) {
    if (!std::strcmp(name, "vkGetInstanceProcAddr"))
        return reinterpret_cast<PFN_vkVoidFunction>(instance_function);
    if (!std::strcmp(name, "vkCreateInstance")) return reinterpret_cast<PFN_vkVoidFunction>(create_instance);
    if (!std::strcmp(name, "vkCreateDevice")) return reinterpret_cast<PFN_vkVoidFunction>(create_device);
    return next_instance_function(of, name);
}

}  // namespace

// How the loader and a layer get to know each other.
extern "C" __attribute__((visibility("default"))) VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
    version->pfnGetInstanceProcAddr = instance_function;
    version->pfnGetDeviceProcAddr = device_function;
    version->pfnGetPhysicalDeviceProcAddr = nullptr;
    return VK_SUCCESS;
}
