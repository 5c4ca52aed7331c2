// Tells on the terminal how far a long render is.
#pragma once
#include <cstdint>

#include "clock.h"

namespace lab {

class Progress {
  public:
    // `target_samples` a pixel. A quiet progress prints nothing.
    Progress(uint32_t target_samples, double first_samples, bool quiet);
    ~Progress();

    // `samples` a pixel and `rays` of this run so far; prints a few times a second.
    void update(double samples, uint64_t rays);

  private:
    uint32_t target_samples_;
    double first_samples_;
    bool quiet_;
    bool terminal_;
    bool printed_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

}  // namespace lab
