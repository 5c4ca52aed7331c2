// Parallel loops on all processors that the program may use, and a thread that watches another one.
#pragma once
#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "platform.h"

namespace lab {

// Calls work(begin, end) for pieces of `piece` indices that cover [0, count); the last may be shorter. The pieces do not depend
// on the number of threads. Rethrows the first exception of any call.
template <typename Work>
void in_parallel(size_t count, size_t piece, const Work& work) {
    const size_t piece_count = (count + piece - 1) / piece;
    std::atomic<size_t> next = 0;
    std::exception_ptr failure;
    std::mutex mutex;
    const auto take_pieces = [&] {
        try {
            for (size_t i = next++; i < piece_count; i = next++) work(i * piece, std::min(count, (i + 1) * piece));
        } catch (...) {
            const std::scoped_lock lock(mutex);
            if (!failure) failure = std::current_exception();
            next = piece_count;
        }
    };
    {
        std::vector<std::jthread> helpers;
        const size_t threads = piece_count > 1 ? std::min(piece_count, processor_count()) : 1;
        try {
            while (helpers.size() + 1 < threads) helpers.emplace_back(take_pieces);
        } catch (const std::system_error&) {  // no more threads to be had: those that run do the work
        }
        take_pieces();
    }
    if (failure) std::rethrow_exception(failure);
}

// Sums work(begin, end) over such pieces in order, so the result is the same to the bit with any number of threads.
template <typename Sum, typename Work>
Sum sum_in_parallel(size_t count, const Work& work) {
    constexpr size_t piece = 1 << 16;
    std::vector<Sum> sums((count + piece - 1) / piece, Sum(0));
    in_parallel(count, piece, [&](size_t begin, size_t end) { sums[begin / piece] = work(begin, end); });
    Sum all(0);
    for (const Sum& sum : sums) all += sum;
    return all;
}

// Calls look() from a thread of its own after each `period`, until that returns false or the watch is destroyed. No condition
// variable with a stop token: in the library of GCC 12 for Windows, that can sleep forever once it is told to stop.
class Watch {
  public:
    template <typename Look>
    Watch(std::chrono::milliseconds period, Look look)
        : thread_([period, look, over = over_.get_future()] {
              while (over.wait_for(period) == std::future_status::timeout && look()) {
              }
          }) {}
    ~Watch() { over_.set_value(); }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

  private:
    std::promise<void> over_;
    std::jthread thread_;  // joined first
};

}  // namespace lab
