// Parallel loops and sums.
#include "parallel.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

namespace lab {
namespace {

TEST(InParallel, VisitsEveryNumberOnce) {
    for (const size_t count : {0, 1, 9, 10, 11, 1000}) {
        SCOPED_TRACE(count);
        std::vector<std::atomic<int>> visits(count);
        in_parallel(count, 10, [&](size_t begin, size_t end) {
            EXPECT_EQ(begin % 10, 0u);
            EXPECT_LE(end - begin, 10u);
            for (size_t i = begin; i < end; ++i) ++visits[i];
        });
        for (const auto& count_of_one : visits) EXPECT_EQ(count_of_one, 1);
    }
}

TEST(InParallel, ThrowsAgainWhatAThreadHasThrown) {
    const auto fail = [](size_t begin, size_t) {
        if (begin == 70) throw std::runtime_error("at 70");
    };
    EXPECT_THROW(in_parallel(100, 10, fail), std::runtime_error);
}

TEST(SumInParallel, AddsEverything) {
    const size_t count = 1'000'003;
    const auto sum = sum_in_parallel<uint64_t>(count, [](size_t begin, size_t end) {
        uint64_t some = 0;
        for (size_t i = begin; i < end; ++i) some += i;
        return some;
    });
    EXPECT_EQ(sum, count * (count - 1) / 2);
}

TEST(Watch, LooksUntilItHasSeenEnough) {
    std::atomic<int> looks = 0;
    const Watch watch(std::chrono::milliseconds(1), [&] { return ++looks < 3; });
    while (looks < 3) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(looks, 3);
}

// One in a thousand waited forever in programs for Windows, as long as a stop token ended them. This finds that now and then.
TEST(Watch, EndsBeforeItsPeriod) {
    std::atomic<int> looks = 0;
    for (int i = 0; i < 200; ++i) {
        const Watch watch(std::chrono::hours(1), [&] { return ++looks > 0; });
        std::this_thread::sleep_for(std::chrono::milliseconds(i % 10));
    }
    EXPECT_EQ(looks, 0);
}

}  // namespace
}  // namespace lab
