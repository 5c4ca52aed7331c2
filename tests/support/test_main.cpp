// main() of the tests that use a device.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/gpu_test.h"

namespace lab {
namespace {

// Fails a test if the validation layers complained while it ran. The driver's own messages are only shown: we cannot fix the
// driver.
class ValidationListener : public testing::EmptyTestEventListener {
    void OnTestEnd(const testing::TestInfo&) override {
        const auto& complaints = test_device().validation_messages();
        for (; validation_count_ < complaints.size(); ++validation_count_)
            ADD_FAILURE() << "validation layer: " << complaints[validation_count_];
        const auto& messages = test_device().driver_messages();
        for (; driver_count_ < messages.size(); ++driver_count_)
            std::printf("[  DRIVER  ] %s\n", messages[driver_count_].c_str());
    }

    // States the device in the report of the tests.
    void OnTestIterationEnd(const testing::UnitTest&, int) override {
        const DeviceDescription& device = test_device().description();
        testing::Test::RecordProperty("device", device.name);
        testing::Test::RecordProperty("driver", device.driver);
        testing::Test::RecordProperty("api_version", device.api_version);
    }

    size_t validation_count_ = 0;
    size_t driver_count_ = 0;
};

// If LAB_TEST_STOP_AT_VERDICT is set, ends a test at its first failure: that is all that seeded mistakes need. A test that finds
// itself too weak or a misuse of Vulkan is not a verdict.
class StoppingListener : public testing::EmptyTestEventListener {
    void OnTestPartResult(const testing::TestPartResult& result) override {
        const std::string message = result.message();
        const bool is_verdict = message.find("too weak") == message.npos && message.find("validation") == message.npos;
        if (result.failed() && is_verdict) throw testing::AssertionException(result);
    }
};

}  // namespace
}  // namespace lab

int main(int argument_count, char** arguments) {
    testing::InitGoogleTest(&argument_count, arguments);
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    listeners.Append(new lab::ValidationListener);
    if (std::getenv("LAB_TEST_STOP_AT_VERDICT")) listeners.Append(new lab::StoppingListener);  // must be the last one
    return RUN_ALL_TESTS();
}
