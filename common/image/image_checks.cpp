#include "image/image_checks.h"

#include <algorithm>
#include <cmath>

#include "error.h"
#include "files/file.h"
#include "image/image.h"

namespace lab {

void fail(const std::filesystem::path& file, const std::string& reason) {
    throw UserError(printable(file.string()) + ": " + reason);
}

void fail_damaged(const std::filesystem::path& file) { fail(file, "damaged image: copy or export it again"); }

void fail_truncated(const std::filesystem::path& file) { fail(file, "the file ends too early: copy or export it again"); }

std::string_view take_until(char end, const std::filesystem::path& file, std::string_view& bytes) {
    const size_t length = bytes.find(end);
    if (length == std::string_view::npos) fail_truncated(file);
    const std::string_view text = bytes.substr(0, length);
    bytes.remove_prefix(length + 1);
    return text;
}

void check_image_size(const std::filesystem::path& file, int64_t width, int64_t height) {
    if (width >= 1 && width <= max_image_extent && height >= 1 && height <= max_image_extent) return;
    fail(file, "an image of " + std::to_string(width) + " x " + std::to_string(height) +
                   " pixels: width and height must be from 1 to " + std::to_string(max_image_extent));
}

void check_memory(const std::filesystem::path& file, uint64_t bytes, uint64_t file_size) {
    if (bytes > memory_limit(file_size))
        fail(file, "its pixels need " + std::to_string(bytes >> 20) + " MiB, far more than a file of " +
                       std::to_string(file_size >> 10) + " KiB should: make the image smaller");
}

bool are_primaries_of_srgb(std::span<const float, 8> chromaticities) {
    constexpr float srgb[] = {0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f};
    return std::ranges::equal(chromaticities, srgb, [](float a, float b) { return std::abs(a - b) < 0.001f; });
}

}  // namespace lab
