#include "gpu/failure.h"

#include <new>

#include "error.h"
#include "gpu/vulkan.h"

namespace lab {

Failure failure_of(const std::exception& error) {
    if (dynamic_cast<const DeviceError*>(&error)) return {2, error.what()};
    if (dynamic_cast<const DeviceFailure*>(&error)) return {3, error.what()};
    if (dynamic_cast<const vk::SystemError*>(&error))
        return {3, std::string("the device failed: ") + error.what()};
    if (dynamic_cast<const std::bad_alloc*>(&error))
        return {3, "out of memory: use a smaller scene or image"};
    return {1, error.what()};
}

}  // namespace lab
