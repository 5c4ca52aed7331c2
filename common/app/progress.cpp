#include "app/progress.h"

#include <algorithm>
#include <cstdio>

#include "clock.h"
#include "platform.h"
#include "rendering/numbers_text.h"

namespace lab {

Progress::Progress(uint32_t target_samples, double first_samples, bool quiet)
    : target_samples_(target_samples),
      first_samples_(first_samples),
      quiet_(quiet),
      terminal_(is_terminal(stderr)) {}

Progress::~Progress() {
    if (printed_ && terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::update(double samples, uint64_t rays) {
    if (quiet_) return;
    // A log file gets a line now and then, a terminal one line that is rewritten.
    const double interval = terminal_ ? 0.2 : 10.0;
    if (seconds_since(last_) < interval) return;
    last_ = Clock::now();
    const double seconds = seconds_since(start_);
    const double rate = (samples - first_samples_) / seconds;
    const double fraction = std::min(samples / target_samples_, 1.0);
    constexpr int bar_width = 24;
    const int filled = static_cast<int>(fraction * bar_width);
    const std::string bar = "[" + std::string(filled, '#') + std::string(bar_width - filled, '.') + "] ";
    char text[160];
    std::snprintf(text, sizeof text, "%.4g/%u samples  %s samples/s  %s rays/s  %s left", samples,
                  target_samples_, short_number(rate).c_str(),
                  short_number(static_cast<double>(rays) / seconds).c_str(),
                  rate > 0 ? duration_text((target_samples_ - samples) / rate).c_str() : "?");
    std::fprintf(stderr, terminal_ ? "\r\033[K%s%s" : "%s%s\n", bar.c_str(), text);
    std::fflush(stderr);
    printed_ = true;
}

}  // namespace lab
