// What an exception means to a user.
#pragma once
#include <exception>
#include <string>

namespace lab {

struct Failure {
    int exit_code;        // 1 bad input or usage, 2 no usable device, 3 device lost or out of memory
    std::string message;  // one line
};

// The same for programs and windows, whatever was thrown.
Failure failure_of(const std::exception& error);

}  // namespace lab
