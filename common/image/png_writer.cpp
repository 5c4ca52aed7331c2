// Writes PNG files: rows are predicted by their neighbours, and all threads compress what is left.
#include <cstdlib>
#include <cstring>

#include "image/encoding.h"
#include "image/image.h"
#include "parallel.h"

namespace lab {
namespace {

constexpr size_t channels = 4;

// Paeth's predictor, from the bytes to the left, above, and above to the left.
int predict(int left, int above, int corner) {
    const int to_left = std::abs(above - corner), to_above = std::abs(left - corner),
              to_corner = std::abs(left + above - 2 * corner);
    return to_left <= to_above && to_left <= to_corner ? left : (to_above <= to_corner ? above : corner);
}

std::string chunk(const std::string& type, const std::string& content) {
    const std::string checked = type + content;
    return big_endian(static_cast<uint32_t>(content.size())) + checked + big_endian(crc(checked));
}

}  // namespace

void write_png(const std::filesystem::path& file, const Texture& image) {
    constexpr char paeth = 4;
    const size_t row_size = channels * image.width;
    std::string rows((1 + row_size) * image.height, '\0');
    in_parallel(image.height, 16, [&](size_t begin, size_t end) {
        for (size_t y = begin; y < end; ++y) {
            const uint8_t* row = image.pixels.data() + y * row_size;
            const auto at = [&](size_t x, size_t back) { return x < back ? 0 : int{row[x - back]}; };
            const auto above = [&](size_t x, size_t back) {
                return y == 0 || x < back ? 0 : int{(row - row_size)[x - back]};
            };
            char* target = rows.data() + y * (1 + row_size);
            *target++ = paeth;
            for (size_t x = 0; x < row_size; ++x)
                *target++ =
                    static_cast<char>(row[x] - predict(at(x, channels), above(x, 0), above(x, channels)));
        }
    });
    const std::string format = {8, 6, 0, 0, 0};  // 8 bits a channel, RGBA, and the only ways to store it
    write_file(file, "\x89PNG\r\n\x1a\n" +
                         chunk("IHDR", big_endian(image.width) + big_endian(image.height) + format) +
                         chunk("IDAT", compress_in_parallel(rows)) + chunk("IEND", ""));
}

}  // namespace lab
