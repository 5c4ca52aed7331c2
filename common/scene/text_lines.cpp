#include "scene/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "error.h"

namespace lab {

void fail_at_line(const std::string& file, size_t line, const std::string& reason) {
    throw UserError(file + ":" + std::to_string(line) + ": " + reason);
}

namespace {

constexpr const char* blanks = " \t";

// Where the comment of a line with numbers starts. Microsoft's run-time library writes 1.#QNAN and -1.#IND for what is no number.
size_t find_comment(std::string_view line) {
    size_t at = line.find('#');
    while (at != std::string_view::npos && at > 0 && line[at - 1] == '.') at = line.find('#', at + 1);
    return at;
}

// A face's line without its comment, and each corner without the slashes behind its last index, as in 1// and 1/2/.
std::string cleaned_face(std::string_view line) {
    std::string cleaned;
    for (const char c : line.substr(0, find_comment(line))) {
        if (c == ' ' || c == '\t') cleaned.resize(cleaned.find_last_not_of('/') + 1);
        cleaned += c;
    }
    cleaned.resize(cleaned.find_last_not_of("/ \t") + 1);
    return cleaned;
}

}  // namespace

std::string clean_text(std::string text) {
    // ZBrush writes NULs behind the last line. A NUL within a line means a binary file, which readers refuse.
    const size_t end = text.find_last_not_of(std::string_view("\0\r\n", 3)) + 1, line_end = text.find_first_of("\r\n", end);
    text.resize(line_end == std::string::npos ? end : line_end);
    std::string_view rest = text;
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
    std::string cleaned, joined;
    cleaned.reserve(rest.size());
    size_t joined_lines = 0;
    while (!rest.empty()) {
        std::string_view line = take_line(rest);
        if (line.ends_with('\\') && !rest.empty()) {
            joined += line.substr(0, line.size() - 1);
            joined += ' ';
            ++joined_lines;
            continue;
        }
        if (joined_lines > 0) line = joined += line;
        const size_t start = std::min(line.find_first_not_of(blanks), line.size());
        if (line.substr(start).starts_with("f ") || line.substr(start).starts_with("f\t"))
            cleaned += cleaned_face(line);
        else
            cleaned += line;
        if (line.substr(start) == "usemtl") cleaned += ' ';  // tinyobjloader skips a keyword without a blank behind it
        cleaned.append(1 + std::exchange(joined_lines, 0), '\n');
        joined.clear();
    }
    return cleaned;
}

std::string_view take_line(std::string_view& text) {
    const size_t length = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, length);
    text.remove_prefix(length);
    text.remove_prefix(text.starts_with("\r\n") ? 2 : text.empty() ? 0 : 1);
    return line;
}

std::vector<std::string_view> words_of(std::string_view line) {
    line = line.substr(0, find_comment(line));
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
    const size_t keyword = line.find_first_not_of(blanks);
    line.remove_prefix(std::min(line.find_first_of(blanks, keyword), line.size()));
    line = line.substr(0, std::min(line.find(" # "), line.find("\t# ")));
    line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
    return line.substr(0, line.find_last_not_of(blanks) + 1);
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
