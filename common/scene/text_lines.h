// The files that a scene is read from, and the statements of .obj and .mtl files.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/file.h"

namespace lab {

// Reads files, remembers which, and hashes their contents in reading order, to recognise changed scenes.
class SourceFiles {
  public:
    // Like read_file().
    std::string read(const std::filesystem::path& file, uint64_t max_bytes) {
        std::string bytes = read_file(file, max_bytes);
        hash_ = hash_text(bytes, hash_);
        names_.push_back(file);
        return bytes;
    }

    uint64_t hash() const { return hash_; }
    const std::vector<std::filesystem::path>& names() const { return names_; }

  private:
    std::vector<std::filesystem::path> names_;
    uint64_t hash_ = hash_text("");
};

// Throws a UserError "<file>:<line>: <reason>"; lines count from 1.
[[noreturn]] void fail_at_line(const std::string& file, size_t line, const std::string& reason);

// Goes through the statements of an .obj or .mtl file, one a line, and leaves out what programs write around them: byte order
// marks, comments, empty lines, the \ that joins two lines, slashes behind a corner's last index, and NULs behind the last line.
// Lines end with \n, \r\n or \r.
class Statements {
  public:
    // The text must outlive the object. Throws UserError if it is binary.
    Statements(std::string file, std::string_view text);

    // Goes to the next statement. Returns false at the end. Throws UserError for 1.#IND and the like, which Microsoft's libraries
    // write for numbers that are not finite.
    bool next();

    std::string_view keyword() const { return keyword_; }

    // What follows the keyword, split at blanks. A name in quotes is one word, with its quotes.
    const std::vector<std::string_view>& words() const { return words_; }

    // All that follows the keyword as one name, without quotes around it. It may contain spaces and #.
    std::string_view name() const;

    // The number of the line on which the statement starts, counted from 1.
    size_t line() const { return line_; }

    // Throws a UserError that names the line.
    [[noreturn]] void fail(const std::string& reason) const { fail_at_line(file_, line_, reason); }

  private:
    std::string_view take_line();
    void split(std::string_view line, bool is_name);

    const std::string file_;
    std::string_view text_;  // behind the current statement
    size_t lines_taken_ = 0;
    size_t line_ = 0;
    std::string_view keyword_;
    std::string_view rest_;
    std::string joined_;  // of a statement on several lines
    std::vector<std::string_view> words_;
};

// A name as a path: without quotes around it, with / for \ as on Windows, and a space for "\ ".
std::string to_path(std::string_view name);

// The word as a number. Empty if it is not one, or if it is infinite or NaN in 32 bits.
std::optional<float> to_number(std::string_view word);

}  // namespace lab
