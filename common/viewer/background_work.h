// Work in a background thread while the window keeps going.
#pragma once
#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "files/project_folder.h"
#include "gpu/device.h"
#include "gpu/vulkan.h"

namespace lab {

// For handlers of exceptions: returns the message for the window, without the project's folder in names of files, or rethrows the
// loss of the device.
inline std::string window_message(const std::exception& error) {
    if (dynamic_cast<const vk::DeviceLostError*>(&error)) throw;
    std::string message = failure_of(error).message;
    const std::string folder = project_folder().generic_string() + "/";
    for (size_t at = message.find(folder); at != std::string::npos; at = message.find(folder)) message.erase(at, folder.size());
    return message;
}

template <typename Result>
class BackgroundWork {
  public:
    // Abandons work in progress. The work must refer only to what outlives this object.
    void start(std::function<Result()> work) {
        abandon();
        work_ = std::async(std::launch::async, std::move(work));
    }

    // Discards the result without waiting. The destructor waits.
    void abandon() {
        std::erase_if(abandoned_, [](const auto& work) { return is_ready(work); });
        if (work_.valid()) abandoned_.push_back(std::move(work_));
    }

    bool is_under_way() const { return work_.valid(); }  // until its result is taken
    bool is_done() const { return work_.valid() && is_ready(work_); }
    void wait(std::chrono::milliseconds longest) const { work_.wait_for(longest); }
    // Returns the result, once, or rethrows the work's exception.
    Result take() { return work_.get(); }

  private:
    static bool is_ready(const std::future<Result>& work) {
        return work.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }

    std::future<Result> work_;
    std::vector<std::future<Result>> abandoned_;
};

}  // namespace lab
