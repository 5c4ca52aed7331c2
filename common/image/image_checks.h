// Checks shared by the image readers.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace lab {

// Largest image file that we read, in bytes.
inline constexpr uint64_t max_image_file_bytes = uint64_t{4} << 30;

// Deflate (PNG, EXR) shrinks data by this factor at most, which exposes damaged sizes before memory is allocated.
inline constexpr uint64_t max_deflate_ratio = 1032;

// Throw UserError: "<file>: <reason>", or that the file is damaged or truncated.
[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason);
[[noreturn]] void fail_damaged(const std::filesystem::path& file);
[[noreturn]] void fail_truncated(const std::filesystem::path& file);

// Removes the text up to and including the first `end`, and returns it without `end`. Throws UserError if there is none.
std::string_view take_until(char end, const std::filesystem::path& file, std::string_view& bytes);

// Throws UserError unless both are in [1, max_image_extent].
void check_image_size(const std::filesystem::path& file, int64_t width, int64_t height);

// Throws UserError if an array of this many bytes exceeds memory_limit().
void check_memory(const std::filesystem::path& file, uint64_t bytes, uint64_t file_size);

// Whether red, green, blue and white (x and y of each) are those of sRGB and BT.709.
bool are_primaries_of_srgb(std::span<const float, 8> chromaticities);

}  // namespace lab
