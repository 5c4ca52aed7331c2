// Numbers as text.
#pragma once
#include <string>

#include "shaders/interface.h"

namespace lab {

// With enough digits to read the same number back.
std::string exact_text(float number);
std::string exact_text(const vec3& v, const char* separator = ",");

// A number of samples per pixel, of which the last ones may be under way: 24.7, or 4096.
std::string samples_text(double samples);

// Three digits and a prefix: "1.23 M" for 1234567.
std::string short_number(double number);
// "12.3 s", "4 min 05 s", "1 h 02 min".
std::string duration_text(double seconds);

}  // namespace lab
