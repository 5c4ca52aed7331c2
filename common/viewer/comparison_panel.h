// Controls and numbers of a second render beside the first.
#pragma once
#include "viewer/comparison.h"

namespace lab {

class ComparisonPanel {
  public:
    explicit ComparisonPanel(const Device& device) : comparison_(device) {}

    // Between Screen::begin_frame() and Screen::show(). Appends to the window of the InsidePanel.
    void draw(const Session& first, const Rectangle& picture);
    Comparison& comparison() { return comparison_; }

  private:
    void draw_choice(const Session& first);
    void draw_numbers(const Session& first) const;

    Comparison comparison_;
};

}  // namespace lab
