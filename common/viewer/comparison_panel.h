// Controls and numbers of a second render beside the first.
#pragma once
#include "viewer/comparison.h"

namespace lab {

class ComparisonPanel {
  public:
    explicit ComparisonPanel(const Device& device) : comparison_(device) {}

    // The line between the pictures. Between Screen::begin_frame() and Screen::show().
    void draw_split(const Rectangle& picture) const;
    // A section of the controls.
    void draw_controls(const Session& first);
    Comparison& comparison() { return comparison_; }

  private:
    void draw_choice(const Session& first);
    void draw_numbers(const Session& first) const;

    Comparison comparison_;
};

}  // namespace lab
