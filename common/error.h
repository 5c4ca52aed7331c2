// Errors that end a program with one line and an exit code; both are part of the command line's contract.
#pragma once
#include <stdexcept>

namespace lab {

// Bad input or usage: the message says what is wrong, where, and what to do. Exit code 1.
struct UserError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// No usable device, or one that lacks what was asked for. Exit code 2.
struct DeviceError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// The device was lost or is out of memory. Exit code 3.
struct DeviceFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace lab
