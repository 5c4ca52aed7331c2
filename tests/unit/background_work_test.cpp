// The window's background work, and the messages that its errors turn into.
#include "viewer/background_work.h"

#include <gtest/gtest.h>

#include "error.h"
#include "gpu/vulkan.h"

namespace lab {
namespace {

TEST(BackgroundWork, IsAbandonedWithoutWaiting) {
    std::promise<void> end;
    BackgroundWork<int> work;
    work.start([may_end = end.get_future().share()] {
        may_end.wait();
        return 1;
    });
    EXPECT_TRUE(work.is_under_way());
    EXPECT_FALSE(work.is_done());
    work.start([] { return 2; });
    while (!work.is_done()) work.wait(std::chrono::milliseconds(1));
    EXPECT_EQ(work.take(), 2);
    EXPECT_FALSE(work.is_under_way());
    end.set_value();
}

template <typename Error>
std::string message_of(const Error& error) {
    BackgroundWork<int> work;
    work.start([&]() -> int { throw error; });
    try {
        work.take();
    } catch (const std::exception& caught) {
        return window_message(caught);
    }
    return "";
}

TEST(BackgroundWork, EveryErrorIsAMessageButTheLossOfTheDevice) {
    EXPECT_EQ(message_of(UserError("bad scene")), "bad scene");
    EXPECT_EQ(message_of(DeviceError("lacks it")), "lacks it");
    EXPECT_EQ(message_of(DeviceFailure("too large")), "too large");
    EXPECT_EQ(message_of(std::bad_alloc()), "out of memory: use a smaller scene or image");
    const std::system_error no_thread(std::make_error_code(std::errc::resource_unavailable_try_again));
    EXPECT_NE(message_of(no_thread).find("raise the limit of memory (ulimit -v)"), std::string::npos);
    EXPECT_NE(message_of(vk::OutOfHostMemoryError("vkCreateImage")).find("the device failed: vkCreateImage"), std::string::npos);
    EXPECT_THROW(message_of(vk::DeviceLostError("vkQueueSubmit")), vk::DeviceLostError);
}

}  // namespace
}  // namespace lab
