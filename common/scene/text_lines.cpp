#include "scene/text_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>

#include "error.h"

namespace lab {
namespace {

constexpr std::string_view blanks = " \t", byte_order_mark = "\xef\xbb\xbf", end_of_text("\0\x1a\r\n \t", 6);

// Statements that contain names. What follows the other keywords are numbers.
bool has_names(std::string_view keyword) {
    static const std::set<std::string_view> keywords = {"mtllib", "usemtl", "newmtl", "g",    "o",
                                                        "bump",   "disp",   "decal",  "refl", "norm"};
    return keyword.starts_with("map_") || keywords.contains(keyword);
}

bool is_blank(char c) { return blanks.find(c) != blanks.npos; }

std::string_view trimmed(std::string_view text) {
    text.remove_prefix(std::min(text.find_first_not_of(blanks), text.size()));
    return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::string_view without_quotes(std::string_view name) {
    const bool is_quoted = name.size() > 1 && name.starts_with('"') && name.ends_with('"');
    return is_quoted ? name.substr(1, name.size() - 2) : name;
}

// Names such as "Material #25" contain a #, so a comment behind them has blanks around its #. Elsewhere only the # of 1.#IND and
// the like does not begin a comment.
std::string_view without_comment(std::string_view text, bool is_name) {
    for (size_t i = text.find('#'); i != text.npos; i = text.find('#', i + 1)) {
        const char before = i == 0 ? ' ' : text[i - 1], behind = i + 1 == text.size() ? ' ' : text[i + 1];
        if (is_name ? is_blank(before) && is_blank(behind) : before != '.' || behind < 'A' || behind > 'Z')
            return text.substr(0, i);
    }
    return text;
}

}  // namespace

void fail_at_line(const std::string& file, size_t line, const std::string& reason) {
    throw UserError(file + ":" + std::to_string(line) + ": " + reason);
}

Statements::Statements(std::string file, std::string_view text) : file_(std::move(file)) {
    // Up to the end of the last line with a statement. A NUL within it means a binary file.
    const size_t end = text.find_last_not_of(end_of_text) + 1;
    text_ = text.substr(0, text.find_first_of("\r\n", end) == text.npos ? end : text.find_first_of("\r\n", end));
    if (text_.find('\0') != text_.npos) throw UserError(file_ + ": not a text file: it is binary");
}

bool Statements::next() {
    std::string_view line;
    do {
        if (text_.empty()) return false;
        line = trimmed(take_line());
        keyword_ = line.substr(0, line.find_first_of(" \t#\\"));
    } while (keyword_.empty());
    line_ = lines_taken_;

    const bool is_name = has_names(keyword_);
    rest_ = trimmed(without_comment(line.substr(keyword_.size()), is_name));
    if (rest_.ends_with('\\')) {
        joined_.clear();
        while (rest_.ends_with('\\')) {
            joined_.append(rest_.substr(0, rest_.size() - 1)) += ' ';
            rest_ = trimmed(without_comment(take_line(), is_name));
        }
        rest_ = trimmed(joined_.append(rest_));
    }
    split(rest_, is_name);
    return true;
}

std::string_view Statements::name() const { return without_quotes(rest_); }

std::string_view Statements::take_line() {
    const size_t length = std::min(text_.find_first_of("\r\n"), text_.size());
    std::string_view line = text_.substr(0, length);
    text_.remove_prefix(length);
    text_.remove_prefix(text_.starts_with("\r\n") ? 2 : text_.empty() ? 0 : 1);
    ++lines_taken_;
    if (line.starts_with(byte_order_mark)) line.remove_prefix(byte_order_mark.size());
    return line;
}

void Statements::split(std::string_view line, bool is_name) {
    words_.clear();
    while (!line.empty()) {
        const size_t quote = is_name && line.starts_with('"') ? line.find('"', 1) : line.npos;
        const size_t end = std::min(line.find_first_of(blanks, quote == line.npos ? 0 : quote), line.size());
        std::string_view word = line.substr(0, end);
        if (!is_name && word.find('#') != word.npos) fail(in_quotes(word) + " is not a finite number");
        if (keyword_ == "f") word = word.substr(0, word.find_last_not_of('/') + 1);
        words_.push_back(word);
        line = trimmed(line.substr(end));
    }
}

std::string to_path(std::string_view name) {
    std::string path(without_quotes(name));
    for (size_t i = path.find('\\'); i != path.npos; i = path.find('\\', i + 1)) {
        if (path[i + 1] == ' ')
            path.erase(i, 1);
        else
            path[i] = '/';
    }
    return path;
}

std::optional<float> to_number(std::string_view word) {
    if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size()) return std::nullopt;
    // from_chars() tells numbers that are too large or too close to 0, but not which of the two they are.
    if (error == std::errc::result_out_of_range && std::abs(std::strtod(std::string(word).c_str(), nullptr)) < 1) return 0.0f;
    const bool in_range = std::abs(value) <= std::numeric_limits<float>::max();  // false for NaN
    if (error != std::errc() || !in_range) return std::nullopt;
    return static_cast<float>(value);
}

}  // namespace lab
