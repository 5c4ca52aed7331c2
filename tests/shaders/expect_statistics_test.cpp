// What the statistical expectations say of a shader that is wrong, and of one that is too noisy to tell.
#include "support/expect_statistics.h"

#include <gtest/gtest-spi.h>

#include <array>
#include <cstdlib>

namespace lab {
namespace {

constexpr MeanEstimate vague{.mean = 1.0, .standard_error = 0.2};

class Expectations : public testing::Test {
    void SetUp() override {
        if (copy_) name_ = copy_;
        unsetenv("LAB_TEST_COPY");
    }
    void TearDown() override { copy_ ? setenv("LAB_TEST_COPY", name_.c_str(), 1) : unsetenv("LAB_TEST_COPY"); }

    const char* copy_ = std::getenv("LAB_TEST_COPY");
    std::string name_;
};

TEST_F(Expectations, SayOfWhatIsWrongThatItIsWrongAndNothingElse) {
    EXPECT_NONFATAL_FAILURE(expect_mean("it", vague, 5.0, 0.01), "is biased");
    const std::array<Difference, 1> off{Difference{.value = 3.0, .standard_error = 0.3}};
    EXPECT_NONFATAL_FAILURE(expect_no_difference("it", off, 0.01), "is off by");
    const std::array<uint64_t, 2> counts{90, 10};
    const std::array<double, 2> even{0.5, 0.5};
    EXPECT_NONFATAL_FAILURE(expect_distribution("it", counts, even, 0.01), "does not follow its density");
    EXPECT_NONFATAL_FAILURE(expect_uniform("it", std::vector<double>(100, 0.25), 0.01), "is not uniform");
}

TEST_F(Expectations, ThatCannotTellNameTheTestOrTheShader) {
    EXPECT_NONFATAL_FAILURE(expect_mean("it", vague, 1.0, 0.01), "the test is too weak");
    setenv("LAB_TEST_COPY", "20_mine", 1);
    EXPECT_NONFATAL_FAILURE(expect_mean("it", vague, 1.0, 0.01), "the shader is too noisy to tell");
}

}  // namespace
}  // namespace lab
