// Whole files in memory: read with checks, written completely or not at all.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

// The bytes of a regular file. UserError if it is missing, not a regular file, empty, unreadable or larger
// than max_bytes, so that no bad path makes the program wait for input or fill the memory, and if its name
// is very long or has control characters, so that it can stand in messages.
std::string read_file(const std::filesystem::path& file, uint64_t max_bytes);

// Largest single allocation, in bytes, for the contents of a file of this size: readers refuse what needs
// more, so that a small hostile file cannot fill the memory.
constexpr uint64_t memory_limit(uint64_t file_size) { return 16 * file_size + (uint64_t{1} << 30); }

// Writes a temporary file in the same folder and renames it. UserError, leaving an older file untouched, if
// any step fails (no such folder, no permission, disk full).
void write_file(const std::filesystem::path& file, std::string_view bytes);

// Throws a UserError if a file with this name cannot be written later or has none of the endings; creates the
// folders on the way. An existing file keeps its contents.
void check_writable(const std::filesystem::path& file, const std::vector<std::string>& endings);

// Text from a file, fit for a terminal: with '?' in place of control characters.
std::string printable(std::string_view text);

// A name from a file, fit for an error message: printable, in double quotes, shortened.
std::string in_quotes(std::string_view name);

// The ending of a file name in lower case, with its dot.
std::string lower_case_extension(const std::filesystem::path& file);

}  // namespace lab
