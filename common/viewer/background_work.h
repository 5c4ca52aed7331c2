// Work in a thread of its own, for a window that must go on meanwhile.
#pragma once
#include <chrono>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "gpu/vulkan.h"

namespace lab {

// To be called where an exception of the work is caught: what the window shows of it while it goes on. The
// loss of the device is thrown again, since nothing can go on without it.
inline std::string window_message(const std::exception& error) {
    if (dynamic_cast<const vk::DeviceLostError*>(&error)) throw;
    return failure_of(error).message;
}

template <typename Result>
class BackgroundWork {
  public:
    // What is under way is abandoned. The work must not refer to anything that may go before this object.
    void start(std::function<Result()> work) {
        abandon();
        work_ = std::async(std::launch::async, std::move(work));
    }

    // Gives up the result without waiting for it. Only the end of this object waits.
    void abandon() {
        std::erase_if(abandoned_, [](const auto& work) { return is_ready(work); });
        if (work_.valid()) abandoned_.push_back(std::move(work_));
    }

    bool is_under_way() const { return work_.valid(); }  // until its result is taken
    bool is_done() const { return work_.valid() && is_ready(work_); }
    void wait(std::chrono::milliseconds longest) const { work_.wait_for(longest); }
    // The result, once. Throws what the work has thrown.
    Result take() { return work_.get(); }

  private:
    static bool is_ready(const std::future<Result>& work) {
        return work.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }

    std::future<Result> work_;
    std::vector<std::future<Result>> abandoned_;
};

}  // namespace lab
