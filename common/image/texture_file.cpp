#include "image/texture_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "files/file.h"
#include "image/encoding.h"
#include "image/image_checks.h"

namespace lab {
namespace {

// Numbers in a file; 0 behind its end.
class Numbers {
  public:
    explicit Numbers(std::string_view bytes) : bytes_(bytes) {}

    uint32_t byte(size_t i) const { return i < bytes_.size() ? static_cast<uint8_t>(bytes_[i]) : 0; }
    uint32_t little16(size_t i) const { return byte(i) | byte(i + 1) << 8; }
    uint32_t little32(size_t i) const { return little16(i) | little16(i + 2) << 16; }
    uint32_t big16(size_t i) const { return byte(i) << 8 | byte(i + 1); }
    uint32_t big32(size_t i) const { return big16(i) << 16 | big16(i + 2); }

  private:
    std::string_view bytes_;
};

[[noreturn]] void fail_unsupported(const std::filesystem::path& file, const std::string& kind) {
    fail(file, kind + " is not supported: export it again as an RGB .png");
}

// The part of a file from `begin`, at most `size` bytes of it; empty behind its end.
std::string_view part(std::string_view bytes, size_t begin, size_t size = std::string_view::npos) {
    return bytes.substr(std::min(begin, bytes.size()), size);
}

// stb_image takes indices beyond a palette from memory that nobody wrote. A palette of full size makes them black.
void prepare_png(const std::filesystem::path& file, std::string& bytes) {
    constexpr size_t signature = 8, before_contents = 8, checksum = 4, largest_palette = 3 * 256;
    bool has_palette = false;
    for (size_t chunk = signature; chunk + before_contents <= bytes.size();) {
        size_t size = Numbers(bytes).big32(chunk);
        const std::string_view type = part(bytes, chunk + 4, 4);
        // It has blue first and colours multiplied by alpha.
        if (type == "CgBI") fail_unsupported(file, "a .png that Xcode has optimised for iOS");
        if (type == "PLTE" && size < largest_palette) {
            if (std::exchange(has_palette, true) || chunk + before_contents + size > bytes.size()) fail_damaged(file);
            bytes.insert(chunk + before_contents + size, largest_palette - size, '\0');
            bytes.replace(chunk, 4, {0, 0, static_cast<char>(largest_palette >> 8), static_cast<char>(largest_palette & 255)});
            size = largest_palette;
        }
        chunk += before_contents + size + checksum;
    }
}

// Walks over the segments of a .jpg file (0xff, marker, two bytes of length) as stb_image does.
void check_jpg(const std::filesystem::path& file, std::string_view bytes) {
    // stb_image up to 2.27 overruns an array if Huffman tables have more than 256 codes, and many scans of a few bytes each make
    // it traverse a large progressive image over and over (encoders make about ten scans).
    constexpr size_t max_scans = 64;
    const Numbers numbers(bytes);
    size_t scans = 0, position = 0;
    uint32_t channels = 0, colour_transform = 3;  // 3: none is given
    while ((position = bytes.find('\xff', position)) != std::string_view::npos) {
        const uint32_t marker = numbers.byte(++position);
        if (marker == 0xff) continue;                                                    // padding
        if (marker == 0 || marker == 1 || (marker >= 0xd0 && marker <= 0xd9)) continue;  // no length
        const size_t contents = position + 3, end = position + 1 + numbers.big16(position + 1);
        const bool starts_frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
        if (marker == 0xda && ++scans > max_scans) fail_damaged(file);
        if (marker == 0xc4) {
            for (size_t table = contents; table < end;) {
                uint32_t code_count = 0;
                for (size_t length = 1; length <= 16; ++length) code_count += numbers.byte(table + length);
                if (code_count > 256) fail_damaged(file);
                table += 17 + code_count;
            }
        } else if (starts_frame) {
            const uint32_t bits = numbers.byte(contents);
            if (marker > 0xc2) fail_unsupported(file, marker > 0xc8 ? "an arithmetically coded .jpg" : "a lossless .jpg");
            if (bits != 8) fail_unsupported(file, "a .jpg of " + std::to_string(bits) + " bits");
            channels = numbers.byte(contents + 5);
        } else if (marker == 0xee && part(bytes, contents, 5) == "Adobe") {
            colour_transform = numbers.byte(contents + 11);
        }
        position = end;
    }
    // Programs disagree about what four channels are, and which of 0 and 255 is full ink, unless Adobe's marker tells.
    if (channels == 4 && colour_transform != 0 && colour_transform != 2)
        fail_unsupported(file, "a CMYK .jpg without Adobe's marker");
}

// The fields of a .bmp header. It has 12 bytes in OS/2 1, 16 or 64 in OS/2 2, and others in Windows.
struct BmpHeader {
    explicit BmpHeader(const Numbers& numbers)
        : pixels(numbers.little32(10)),
          size(numbers.little32(14)),
          width(is_short() ? numbers.little16(18) : numbers.little32(18)),
          height(is_short() ? numbers.little16(20) : numbers.little32(22)),
          bits(is_short() ? numbers.little16(24) : numbers.little16(28)),
          compression(size >= 40 ? numbers.little32(30) : uncompressed),
          colours(size >= 40 ? numbers.little32(46) : 0) {}

    bool is_short() const { return size == 12; }
    size_t end() const { return 14 + size_t{size}; }

    static constexpr uint32_t uncompressed = 0, with_masks = 3, offset_of_masks = 54;
    uint32_t pixels;  // their offset
    uint32_t size, width, height, bits, compression;
    uint32_t colours;  // in the palette; 0: as many as there are indices
};

// The masks of red, green, blue and alpha. Those of a header of 40 bytes lie behind it, which is where they are in longer ones.
std::string bmp_masks(const std::filesystem::path& file, const BmpHeader& header, const Numbers& numbers) {
    std::array<uint32_t, 4> masks{};
    if (header.compression == BmpHeader::with_masks) {
        const size_t count = header.size >= 56 ? 4 : 3;
        for (size_t i = 0; i < count; ++i) masks[i] = numbers.little32(BmpHeader::offset_of_masks + 4 * i);
        for (size_t i = 0; i < count; ++i) {
            if (std::popcount(masks[i]) > 8) fail_unsupported(file, "a .bmp with more than 8 bits a channel");
            if (masks[i] == 0 && i < 3) fail_unsupported(file, "a .bmp without red, green or blue");
        }
    } else if (header.bits == 16) {
        masks = {0x7c00, 0x3e0, 0x1f};
    } else if (header.bits == 32) {
        masks = {0xff0000, 0xff00, 0xff};
    }
    std::string bytes;
    for (const uint32_t mask : masks) bytes += little_endian(mask);
    return bytes;
}

// 256 colours of four bytes; black behind the end of those in the file.
std::string bmp_palette(const BmpHeader& header, std::string_view bytes) {
    const size_t size = header.is_short() ? 3 : 4, used = header.colours > 0 ? header.colours : size_t{1} << header.bits;
    const size_t count = std::min({used, (header.pixels - header.end()) / size, size_t{256}});
    std::string palette;
    for (size_t i = 0; i < count; ++i) {
        palette += part(bytes, header.end() + i * size, 3);
        palette.resize(4 * (i + 1));
    }
    palette.resize(4 * 256);
    return palette;
}

// stb_image misreads the palettes of OS/2, palettes that end early, and the masks of some headers. All kinds become one: with
// the header of Windows' version 4, masks in it, and a whole palette.
void prepare_bmp(const std::filesystem::path& file, std::string& bytes) {
    const Numbers numbers(bytes);
    const BmpHeader header(numbers);
    const auto is_among = [](uint32_t number, std::initializer_list<uint32_t> known) {
        return std::ranges::count(known, number) > 0;
    };
    if (!is_among(header.size, {12, 16, 40, 52, 56, 64, 108, 124}))
        fail_unsupported(file, "a .bmp with a header of " + std::to_string(header.size) + " bytes");
    const bool has_masks = header.compression == BmpHeader::with_masks && header.size != 64 && is_among(header.bits, {16, 32});
    if (header.compression != BmpHeader::uncompressed && !has_masks) fail_unsupported(file, "a compressed .bmp");
    if (!is_among(header.bits, {1, 4, 8, 16, 24, 32}))
        fail_unsupported(file, "a .bmp of " + std::to_string(header.bits) + " bits");
    if (header.pixels < header.end() + (header.size == 40 && has_masks ? 12 : 0)) fail_damaged(file);

    constexpr uint32_t rewritten_size = 108, headers = 14 + rewritten_size;
    const std::string masks = bmp_masks(file, header, numbers), palette = header.bits <= 8 ? bmp_palette(header, bytes) : "";
    std::string rewritten = "BM" + std::string(8, '\0') + little_endian(static_cast<uint32_t>(headers + palette.size()));
    rewritten += little_endian(rewritten_size) + little_endian(header.width) + little_endian(header.height);
    rewritten += little_endian(uint16_t{1}) + little_endian(static_cast<uint16_t>(header.bits));
    rewritten += little_endian(is_among(header.bits, {16, 32}) ? BmpHeader::with_masks : BmpHeader::uncompressed);
    rewritten += std::string(20, '\0') + masks;
    rewritten.resize(headers);
    bytes.replace(0, header.pixels, rewritten + palette);
}

// stb_image knows neither rows from the right nor palettes that start at another index than 0, and takes palettes of pictures
// that do not use them for a mistake. Every palette becomes one that covers all indices, whose missing colours are black.
void prepare_tga(const std::filesystem::path& file, TextureFile& texture) {
    constexpr size_t header = 18;
    std::string& bytes = texture.bytes;
    const Numbers numbers(bytes);
    const uint32_t palette_kind = numbers.byte(1), kind = numbers.byte(2), descriptor = numbers.byte(17);
    const uint32_t kind_of_colours = kind & ~8u;  // without the bit for run-length encoding
    const bool uses_palette = kind_of_colours == 1;
    const bool is_tga = kind_of_colours >= 1 && kind_of_colours <= 3 && palette_kind <= 1 && uses_palette <= (palette_kind == 1);
    if (bytes.size() < header || !is_tga) return;
    texture.format = ".tga";
    if (descriptor >> 6) fail_unsupported(file, "a .tga with interleaved rows");
    texture.is_mirrored = descriptor & 16;
    texture.without_alpha = (descriptor & 15) == 0;
    if (palette_kind == 0) return;

    const size_t start = numbers.little16(3), length = numbers.little16(5), colour_size = (numbers.byte(7) + 7) / 8;
    const size_t palette = header + numbers.byte(0), pixels = palette + length * colour_size;
    std::string rewritten = bytes.substr(0, header), colours;
    rewritten[0] = 0;
    if (uses_palette) {
        const size_t count = std::min(std::max(start + length, size_t{1} << std::min(numbers.byte(16), 16u)), size_t{65535});
        colours = std::string(start * colour_size, '\0') + std::string(part(bytes, palette, length * colour_size));
        colours.resize(count * colour_size);
        rewritten.replace(3, 4, little_endian(uint16_t{0}) + little_endian(static_cast<uint16_t>(count)));
    } else {
        rewritten[1] = 0;
    }
    bytes.replace(0, pixels, rewritten + colours);
}

}  // namespace

TextureFile prepare_texture(const std::filesystem::path& file, std::string bytes) {
    TextureFile texture{{}, std::move(bytes)};
    if (texture.bytes.starts_with("\x89PNG\r\n\x1a\n")) {
        texture.format = ".png";
        prepare_png(file, texture.bytes);
    } else if (texture.bytes.starts_with("BM")) {
        texture.format = ".bmp";
        prepare_bmp(file, texture.bytes);
    } else if (texture.bytes.starts_with("\xff\xd8")) {
        texture.format = ".jpg";
        check_jpg(file, texture.bytes);
    } else {
        prepare_tga(file, texture);
    }
    return texture;
}

}  // namespace lab
