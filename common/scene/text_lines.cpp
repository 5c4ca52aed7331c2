#include "scene/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "error.h"

namespace lab {

void fail_at_line(const std::string& file, size_t line, const std::string& reason) {
    throw UserError(file + ":" + std::to_string(line) + ": " + reason);
}

std::string_view take_line(std::string_view& text) {
    const size_t length = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, length);
    text.remove_prefix(length);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
    return line;
}

std::vector<std::string_view> words_of(std::string_view line) {
    line = line.substr(0, line.find('#'));
    std::vector<std::string_view> words;
    words.reserve(8);
    for (;;) {
        line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
        if (line.empty()) return words;
        words.push_back(line.substr(0, line.find_first_of(" \t")));
        line.remove_prefix(words.back().size());
    }
}

std::string_view name_in(std::string_view line) {
    constexpr const char* blank = " \t";
    const size_t keyword = line.find_first_not_of(blank);
    line.remove_prefix(std::min(line.find_first_of(blank, keyword), line.size()));
    line.remove_prefix(std::min(line.find_first_not_of(blank), line.size()));
    return line.substr(0, line.find_last_not_of(blank) + 1);
}

std::optional<float> to_number(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    const bool in_range = std::abs(value) <= std::numeric_limits<float>::max();  // false for NaN
    if (error != std::errc() || end != word.data() + word.size() || !in_range) return std::nullopt;
    return static_cast<float>(value);
}

}  // namespace lab
