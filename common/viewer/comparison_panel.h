// Controls and numbers of a second render beside the first.
#pragma once
#include "viewer/comparison.h"

namespace lab {

// The line between the pictures. Between Screen::begin_frame() and Screen::show().
void draw_split(const Comparison& comparison, const Rectangle& picture);

// A section of the controls.
void draw_controls(Comparison& comparison, const Session& first);

}  // namespace lab
