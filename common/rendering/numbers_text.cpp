#include "rendering/numbers_text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lab {

std::string exact_text(float number) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", number);
    return text;
}

std::string exact_text(const vec3& v, const char* separator) {
    return exact_text(v.x) + separator + exact_text(v.y) + separator + exact_text(v.z);
}

std::string short_number(double number) {
    const char* prefixes[] = {"", " k", " M", " G", " T"};
    size_t prefix = 0;
    while (number >= 999.5 && prefix + 1 < std::size(prefixes)) {
        number /= 1000;
        ++prefix;
    }
    char text[40];
    std::snprintf(text, sizeof text, "%.3g%s", number, prefixes[prefix]);
    return text;
}

std::string samples_text(double samples) {
    char text[40];
    std::snprintf(text, sizeof text, samples < 100 ? "%.3g" : "%.0f", samples);
    return text;
}

std::string duration_text(double seconds) {
    char text[64];
    if (seconds < 60) {
        std::snprintf(text, sizeof text, "%.3g s", seconds);
    } else {
        const auto whole = std::llround(std::min(seconds, 1e12));
        if (whole < 3600)
            std::snprintf(text, sizeof text, "%lld min %02lld s", whole / 60, whole % 60);
        else
            std::snprintf(text, sizeof text, "%lld h %02lld min", whole / 3600, whole / 60 % 60);
    }
    return text;
}

}  // namespace lab
