#include "viewer/background_work.h"

#include "gpu/failure.h"
#include "gpu/vulkan.h"

namespace lab {

std::string window_message(const std::exception& error) {
    if (dynamic_cast<const vk::DeviceLostError*>(&error)) throw;
    return failure_of(error).message;
}

}  // namespace lab
