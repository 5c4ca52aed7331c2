// What an exception means to a user.
#pragma once
#include <new>
#include <string>

#include "error.h"
#include "gpu/vulkan.h"

namespace lab {

struct Failure {
    int exit_code;        // as error.h says
    std::string message;  // one line
};

// The same for programs and windows, whatever was thrown.
inline Failure failure_of(const std::exception& error) {
    if (dynamic_cast<const DeviceError*>(&error)) return {2, error.what()};
    if (dynamic_cast<const DeviceFailure*>(&error)) return {3, error.what()};
    if (dynamic_cast<const vk::SystemError*>(&error))
        return {3, std::string("the device failed: ") + error.what()};
    if (dynamic_cast<const std::bad_alloc*>(&error))
        return {3, "out of memory: use a smaller scene or image"};
    return {1, error.what()};
}

}  // namespace lab
