// Checks that the readers of image files share.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lab {

// Largest image file that is read, in bytes.
inline constexpr uint64_t max_image_file_bytes = uint64_t{4} << 30;

// Deflate (PNG, EXR) shrinks data at most by this factor, which exposes damaged sizes before memory is allocated.
inline constexpr uint64_t max_deflate_ratio = 1032;

// Throw UserError: "<file>: <reason>", or that the file is cut off.
[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason);
[[noreturn]] void fail_truncated(const std::filesystem::path& file);

// Removes and returns the text before the first `end`, which goes, too. Throws UserError without one.
std::string_view take_until(char end, const std::filesystem::path& file, std::string_view& bytes);

// Throws UserError unless both are in [1, max_image_extent].
void check_image_size(const std::filesystem::path& file, int64_t width, int64_t height);

// Throws UserError if an array of so many bytes is above memory_limit().
void check_memory(const std::filesystem::path& file, uint64_t bytes, uint64_t file_size);

}  // namespace lab
