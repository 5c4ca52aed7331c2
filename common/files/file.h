// Whole files in memory: read with checks, written completely or not at all. Hashes of their contents.
#pragma once
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lab {

// Reads a regular file. Throws UserError if it is missing, not regular, empty, unreadable or larger than max_bytes, or if its
// name does not fit into a message (over 1000 bytes, control characters).
std::string read_file(const std::filesystem::path& file, uint64_t max_bytes);

// Largest single allocation, in bytes, while reading a file of this size: a small hostile file must not exhaust memory.
constexpr uint64_t memory_limit(uint64_t file_size) { return 16 * file_size + (uint64_t{1} << 30); }

// Writes a temporary file and renames it. If any step fails, throws UserError and leaves an existing file untouched, whose mode
// is kept. Symbolic links are followed.
void write_file(const std::filesystem::path& file, std::string_view bytes);
void write_file(const std::filesystem::path& file, std::span<const std::string_view> parts);  // one after another

// Creates the folders of a file to be written later. Throws UserError if the file has none of the endings or cannot be written.
// An existing file keeps its contents.
void check_writable(const std::filesystem::path& file, const std::vector<std::string>& endings);

// A path whose ~/ at the start stands for the user's home folder.
std::filesystem::path expand_home(const std::filesystem::path& path);

// The text with every control character replaced by '?'.
std::string printable(std::string_view text);

// A name for messages: printable, in double quotes, cut after 80 bytes.
std::string in_quotes(std::string_view name);

// The extension in lower case, with its dot.
std::string lower_case_extension(const std::filesystem::path& file);

// FNV-1a hash of a text, continuing from `hash`.
inline uint64_t hash_text(std::string_view text, uint64_t hash = 14695981039346656037ull) {
    for (const char c : text) hash = (hash ^ static_cast<uint8_t>(c)) * 1099511628211ull;
    return hash;
}

// A hash as records and reports write it, without leading zeros.
inline std::string hexadecimal(uint64_t number) {
    char text[16];
    return {text, std::to_chars(text, text + sizeof text, number, 16).ptr};
}

}  // namespace lab
