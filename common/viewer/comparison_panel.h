// Controls and labels of the comparison.
#pragma once
#include "viewer/comparison.h"

namespace lab {

// Names a half of the picture: its chapter, and if both are the same, also the settings that differ.
std::string half_label(const Session& session, const Session& other);

// Draws the dividing line and the labels. Call between Screen::begin_frame() and Screen::show().
void draw_halves(const Comparison& comparison, const Session& first, const Rectangle& picture);

// Draws a section of the controls.
void draw_controls(Comparison& comparison, const Session& first);

}  // namespace lab
