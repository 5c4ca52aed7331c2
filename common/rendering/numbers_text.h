// Numbers as text.
#pragma once
#include <string>

#include "shaders/interface.h"

namespace lab {

// With as many digits as tell it from every other number.
std::string exact_text(float number);
std::string exact_text(const vec3& v, const char* separator = ",");

// For people: "1.23 M" for 1234567, "950" for 950: three digits and a prefix.
std::string short_number(double number);
// "12.3 s", "4 min 05 s", "1 h 02 min".
std::string duration_text(double seconds);

}  // namespace lab
