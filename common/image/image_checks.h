// Checks that the readers of image files share.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace lab {

// Largest image file that is read, in bytes.
inline constexpr uint64_t max_image_file_bytes = uint64_t{4} << 30;

// Deflate (in PNG and EXR) makes data at most this many times smaller. So a damaged size is found before
// memory for it is allocated.
inline constexpr uint64_t max_deflate_ratio = 1032;

// Throw the UserErrors "<file>: <reason>" and that the file is cut off.
[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason);
[[noreturn]] void fail_truncated(const std::filesystem::path& file);

// Takes the text before the first `end`, and `end` itself, off what is left of a file. UserError without one.
std::string_view take_until(char end, const std::filesystem::path& file, std::string_view& bytes);

// UserError unless both are in [1, max_image_extent].
void check_image_size(const std::filesystem::path& file, int64_t width, int64_t height);

// UserError if an array of so many bytes is above memory_limit().
void check_memory(const std::filesystem::path& file, uint64_t bytes, uint64_t file_size);

}  // namespace lab
