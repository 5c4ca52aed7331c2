// The files that a scene is read from, and text line by line, for checks that tinyobjloader lacks: it reads anything that is not
// a number as 0.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/file.h"

namespace lab {

// Reads files and hashes their contents in reading order, to recognise changed scenes.
class SourceFiles {
  public:
    // Like read_file().
    std::string read(const std::filesystem::path& file, uint64_t max_bytes) {
        std::string bytes = read_file(file, max_bytes);
        hash_ = hash_text(bytes, hash_);
        return bytes;
    }

    uint64_t hash() const { return hash_; }

  private:
    uint64_t hash_ = hash_text("");
};

// Throws a UserError "<file>:<line>: <reason>"; lines count from 1.
[[noreturn]] void fail_at_line(const std::string& file, size_t line, const std::string& reason);

// The text of an .obj or .mtl file as tinyobjloader should see it, with the same numbers of lines: without a byte order mark,
// NULs at its end, comments behind faces, and slashes behind a corner's last index; a line that ends with \ is joined with the
// next.
std::string clean_text(std::string text);

// Removes and returns the first line of the text. Lines end with \n, \r\n or \r.
std::string_view take_line(std::string_view& text);

// The words of a line, separated by spaces and tabs, up to a comment (# except behind a point).
std::vector<std::string_view> words_of(std::string_view line);

// The name after a line's keyword, without surrounding spaces and tabs. It may contain spaces and #, but " # " starts a comment.
std::string_view name_in(std::string_view line);

// The word as a number. Empty if it is not one, or if it is infinite or NaN in 32 bits.
std::optional<float> to_number(std::string_view word);

}  // namespace lab
