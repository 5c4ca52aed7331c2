// Controls and numbers of a second render beside the first.
#pragma once
#include "viewer/comparison.h"

namespace lab {

// Names a half of the picture: its chapter, and if the other half is of the same what is set otherwise.
std::string half_label(const Session& session, const Session& other);

// The line between the pictures, and what they are. Between Screen::begin_frame() and Screen::show().
void draw_halves(const Comparison& comparison, const Session& first, const Rectangle& picture);

// A section of the controls.
void draw_controls(Comparison& comparison, const Session& first);

}  // namespace lab
