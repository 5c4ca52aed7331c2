// The validation layers watch all tests in this program: see tests/support/test_main.cpp.
#include "support/gpu_test.h"

namespace lab {
namespace {

TEST(Validation, NoticesMistakes) {
    const Device device({.choice = "", .validation = true});
    EXPECT_TRUE(device.validation_messages().empty());
    const vk::BufferCreateInfo buffer_without_bytes({}, 0, vk::BufferUsageFlagBits::eStorageBuffer);
    const vk::raii::Buffer buffer(device.handle(), buffer_without_bytes);
    ASSERT_EQ(device.validation_messages().size(), 1u);
    EXPECT_NE(device.validation_messages().front().find("VUID-VkBufferCreateInfo-size"), std::string::npos);
}

}  // namespace
}  // namespace lab
