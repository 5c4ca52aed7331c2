// Images as other programs write them.
#include <zlib.h>

#include "files/project_folder.h"
#include "film/film_file.h"
#include "image/encoding.h"
#include "image/image.h"
#include "scene/scene.h"
#include "statistics/error_metrics.h"
#include "test_files.h"

namespace lab {
namespace {

using Bytes = std::vector<uint8_t>;
using Numbers = std::vector<float>;

template <typename... Values>
std::string bytes(Values... values) {
    return {static_cast<char>(values)...};
}

std::string big_endian(uint32_t number) { return bytes(number >> 24, number >> 16 & 255, number >> 8 & 255, number & 255); }

// The red, green and blue of all pixels.
Bytes colours(const Texture& texture) {
    Bytes rgb;
    for (size_t i = 0; i < texture.pixels.size(); ++i)
        if (i % 4 < 3) rgb.push_back(texture.pixels[i]);
    return rgb;
}

std::string png_chunk(const std::string& type, const std::string& contents) {
    const std::string text = type + contents;
    const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size()));
    return big_endian(static_cast<uint32_t>(contents.size())) + text + big_endian(static_cast<uint32_t>(checksum));
}

// A row of four pixels with 8-bit indices.
std::string png_with_palette(const std::string& indices, const std::string& palette) {
    return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", big_endian(4) + big_endian(1) + bytes(8, 3, 0, 0, 0)) +
           png_chunk("PLTE", palette) + png_chunk("IDAT", compress_in_parallel(bytes(0) + indices)) + png_chunk("IEND", "");
}

// A .bmp file: the header's contents after its size, then masks or a palette, then rows.
std::string bmp(const std::string& header, const std::string& table, const std::string& rows) {
    const auto size = static_cast<uint32_t>(4 + header.size());
    return "BM" + std::string(8, '\0') + little_endian(static_cast<uint32_t>(14 + size + table.size())) + little_endian(size) +
           header + table + rows;
}

// The contents of a header of 40 bytes, or of more.
std::string bmp_header(int width, int height, int bits, int compression = 0, int colours = 0, const std::string& further = "") {
    return little_endian(width) + little_endian(height) + bytes(1, 0, bits, 0) + little_endian(compression) +
           std::string(12, '\0') + little_endian(colours) + std::string(4, '\0') + further;
}

std::string tga(int kind, int bits, int descriptor, const std::string& palette_description, const std::string& contents) {
    return bytes(0, palette_description[4] != 0, kind) + palette_description + bytes(0, 0, 0, 0, 2, 0, 2, 0, bits, descriptor) +
           contents;
}
const std::string no_palette(5, '\0');

const Bytes red_green_blue_white{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};

// Memory that nobody wrote would differ from run to run, and be red in MemorySanitizer.
TEST(ForeignTextures, ColoursBeyondAPaletteAreBlack) {
    const TestFolder folder;
    const Bytes expected{1, 2, 3, 0, 0, 0, 0, 0, 0, 1, 2, 3};
    const auto read = [&](const std::string& contents) { return colours(read_texture(folder.write("a", contents))); };
    EXPECT_EQ(read(png_with_palette(bytes(0, 1, 255, 0), bytes(1, 2, 3))), expected);
    EXPECT_EQ(read(bmp(bmp_header(4, 1, 8, 0, 1), bytes(3, 2, 1, 0), bytes(0, 1, 255, 0))), expected);
    EXPECT_EQ(read(bmp(bytes(4, 0, 1, 0, 1, 0, 8, 0), bytes(3, 2, 1), bytes(0, 1, 255, 0))), expected);
    EXPECT_EQ(read(tga(1, 8, 0x20, bytes(0, 0, 1, 0, 24), bytes(3, 2, 1, 0, 1, 255, 0))), expected);
    EXPECT_USER_ERROR(read(png_with_palette(bytes(0, 0, 0, 0), "").insert(33, png_chunk("PLTE", bytes(1, 2, 3)))), "damaged");
}

TEST(ForeignTextures, BmpOfEachHeader) {
    const TestFolder folder;
    const auto read = [&](const std::string& contents) { return colours(read_texture(folder.write("a.bmp", contents))); };
    const std::string rgbw = bytes(0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255);
    const std::string os2 = bytes(4, 0, 1, 0, 1, 0, 8, 0);
    std::string palette;
    for (int i = 0; i < 256; ++i) palette += bytes(i, i, i);
    EXPECT_EQ(read(bmp(os2, palette, bytes(0, 251, 252, 255))), (Bytes{0, 0, 0, 251, 251, 251, 252, 252, 252, 255, 255, 255}));
    EXPECT_EQ(read(bmp(little_endian(4) + little_endian(1) + bytes(1, 0, 24, 0), "", rgbw)), red_green_blue_white);

    // Rows from the top.
    EXPECT_EQ(read(bmp(bmp_header(2, -2, 24), "", rgbw.substr(0, 6) + bytes(0, 0) + rgbw.substr(6) + bytes(0, 0))),
              red_green_blue_white);

    // Masks behind the header, in it, and with alpha.
    const std::string masks = little_endian(0xff) + little_endian(0xff00) + little_endian(0xff0000),
                      alpha = little_endian(0xff000000);
    const std::string rgba = bytes(255, 0, 0, 9, 0, 255, 0, 9, 0, 0, 255, 9, 255, 255, 255, 9);
    EXPECT_EQ(read(bmp(bmp_header(4, 1, 32, 3), masks, rgba)), red_green_blue_white);
    EXPECT_EQ(read(bmp(bmp_header(4, 1, 32, 3, 0, masks), "", rgba)), red_green_blue_white);
    EXPECT_EQ(read(bmp(bmp_header(4, 1, 32, 3, 0, masks + alpha), "", rgba)), red_green_blue_white);
    EXPECT_EQ(read_texture(folder / "a.bmp").pixels[3], 9);
    EXPECT_EQ(read(bmp(bmp_header(4, 1, 32, 3, 0, masks + alpha + std::string(52, '\0')), "", rgba)), red_green_blue_white);
}

TEST(ForeignTextures, TgaFromTheRightAndWithPalettes) {
    const TestFolder folder;
    const auto read = [&](const std::string& contents) { return colours(read_texture(folder.write("a.tga", contents))); };
    EXPECT_EQ(read(tga(2, 24, 0x30, no_palette, bytes(0, 255, 0, 0, 0, 255, 255, 255, 255, 255, 0, 0))), red_green_blue_white);
    const std::string palette = bytes(0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255);
    EXPECT_EQ(read(tga(1, 8, 0x20, bytes(7, 0, 4, 0, 24), palette + bytes(7, 8, 9, 10))), red_green_blue_white);
    EXPECT_EQ(read(tga(2, 24, 0x20, bytes(0, 0, 1, 0, 24), bytes(9, 9, 9) + palette)), red_green_blue_white);
    EXPECT_USER_ERROR(read(tga(2, 24, 0x40, no_palette, palette)), "interleaved");
}

TEST(ForeignTextures, OfKindsThatAreNotRead) {
    const TestFolder folder;
    const auto refuse = [&](const std::string& contents, const std::string& words) {
        EXPECT_USER_ERROR(read_texture(folder.write("a", contents)), words);
    };
    refuse(bmp(bmp_header(4, 1, 8, 1), "", ""), "a compressed .bmp is not supported: export it again as an RGB .png");
    refuse(bmp(bmp_header(4, 1, 2), "", ""), "a .bmp of 2 bits is not supported");
    refuse(bmp(bytes(0, 0), "", ""), "a .bmp with a header of 6 bytes is not supported");
    refuse(bmp(bmp_header(1, 1, 32, 3, 0, little_endian(0x3ff) + little_endian(0xff000) + little_endian(0x300000)), "", "abcd"),
           "a .bmp with more than 8 bits a channel is not supported");
    const auto jpg = [](const std::string& adobe, int frame, int bits, int channels) {
        return bytes(0xff, 0xd8) + adobe + bytes(0xff, frame, 0, 8 + 3 * channels, bits, 0, 1, 0, 1, channels);
    };
    refuse(jpg("", 0xc0, 8, 4), "a CMYK .jpg without Adobe's marker is not supported");
    refuse(jpg(bytes(0xff, 0xee, 0, 14) + "Adobe" + std::string(6, '\0') + bytes(1), 0xc0, 8, 4), "without Adobe's marker");
    refuse(jpg(bytes(0xff, 0xee, 0, 14) + "Adobe" + std::string(6, '\0') + bytes(0), 0xc0, 8, 4), "this kind of .jpg");
    refuse(jpg("", 0xc3, 8, 3), "a lossless .jpg is not supported");
    refuse(jpg("", 0xc9, 8, 3), "an arithmetically coded .jpg is not supported");
    refuse(jpg("", 0xc1, 12, 3), "a .jpg of 12 bits is not supported");
    refuse("\x89PNG\r\n\x1a\n" + png_chunk("CgBI", bytes(0, 0, 0, 0)), "Xcode");
    refuse("\x89PNG\r\n\x1a\n", "this kind of .png is not supported, or it is damaged");
    refuse(tga(1, 12, 0, bytes(0, 0, 1, 0, 24), "abc"), "this kind of .tga is not supported, or it is damaged");
    refuse("GIF89a and so on, which is no texture", "not a texture: it must be a .png, .jpg, .bmp or .tga file");
}

TEST(ForeignTextures, AlphaHasNoEffectAndANote) {
    const TestFolder folder;
    folder.write("a.mtl", "newmtl m\nmap_Kd a.tga\n");
    folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
    const auto notes = [&](int alpha, int alpha_bits) {
        folder.write("a.tga", tga(2, 32, alpha_bits, no_palette, std::string(15, '\0') + bytes(alpha)));
        return std::ranges::count_if(load_scene(folder / "a.obj").warnings, [](const std::string& note) {
            return note.find("alpha has no effect") != std::string::npos;
        });
    };
    EXPECT_EQ(notes(200, 8), 1);
    EXPECT_EQ(notes(200, 0), 0) << "the file has no alpha";
    folder.write("a.mtl", "newmtl m\nKd 1 1 1\n");
    EXPECT_EQ(notes(200, 8), 0);
}

std::string hdr(const std::string& header, int width, const std::string& pixels) {
    return "#?RADIANCE\n" + header + "\n-Y 1 +X " + std::to_string(width) + "\n" + pixels;
}

TEST(ForeignHdr, OldRunLengths) {
    const TestFolder folder;
    std::vector<std::string> notes;
    const auto read = [&](int width, const std::string& pixels) {
        return read_radiance(folder.write("a.hdr", hdr("", width, pixels)), notes).pixels;
    };
    const std::string white = bytes(128, 128, 128, 129), red = bytes(128, 0, 0, 129);
    EXPECT_EQ(read(5, red + bytes(1, 1, 1, 3) + white), (Numbers{1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 1}));
    // Counts that follow each other are digits; after a pixel they start again.
    EXPECT_EQ(read(600, white + bytes(1, 1, 1, 255) + red + bytes(1, 1, 1, 86, 1, 1, 1, 1) + white), [&] {
        Numbers numbers(3 * 600, 1);
        for (size_t i = 256; i < 256 + 343; ++i) numbers[3 * i + 1] = numbers[3 * i + 2] = 0;
        return numbers;
    }());
    EXPECT_USER_ERROR(read(5, bytes(1, 1, 1, 5)), "run-length");
    EXPECT_USER_ERROR(read(5, red + bytes(1, 1, 1, 5)), "run-length");
    EXPECT_USER_ERROR(read(5, red + bytes(1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1)), "run-length");
    EXPECT_USER_ERROR(read(5, red + bytes(1, 1, 1, 3)), "ends too early");
}

TEST(ForeignHdr, Headers) {
    const TestFolder folder;
    std::vector<std::string> notes;
    const auto read = [&](const std::string& header) {
        return read_radiance(folder.write("a.hdr", hdr(header, 1, bytes(128, 64, 32, 129))), notes).pixels;
    };
    EXPECT_EQ(read("EXPOSURE=4\nCOLORCORR=1 0.5 2\nEXPOSURE= 2\n"), (Numbers{0.125f, 0.125f, 0.015625f}));
    EXPECT_TRUE(notes.empty());
    const std::string crlf = "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\nEXPOSURE=2\r\n\r\n-Y 1 +X 1\r\n";
    EXPECT_EQ(read_radiance(folder.write("a.hdr", crlf + bytes(128, 64, 32, 129)), notes).pixels, (Numbers{0.5f, 0.25f, 0.125f}));
    for (const char* exposure : {"0", "-1", "inf", "nan", "1e-30\nEXPOSURE=1e-300"})
        EXPECT_USER_ERROR(read("EXPOSURE=" + std::string(exposure) + "\n"), "EXPOSURE");
    EXPECT_USER_ERROR(read("EXPOSURE=\n"), "its EXPOSURE needs 1 numbers");
    EXPECT_USER_ERROR(read("COLORCORR=1 1\n"), "its COLORCORR needs 3 numbers");
    read("PRIMARIES=0.64 0.33 0.30 0.60 0.15 0.06 0.3127 0.3290\n");
    EXPECT_TRUE(notes.empty());
    read("PRIMARIES=0.64 0.33 0.29 0.60 0.15 0.06 0.333 0.333\n");
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_PRED_FORMAT2(testing::IsSubstring, "a.hdr: its primaries are not those of sRGB", notes[0]);
}

// A file of 3 x 2 pixels of 1 to 6 in red and in the channel "Z".
std::string exr_file(const TestFolder& folder) {
    ExrFile exr{{3, 2, {}}, {{"Z", {1, 2, 3, 4, 5, 6}}}, {{"padding", std::string(64, 'x')}}};
    for (const float red : exr.channels["Z"])
        for (const float value : {red, 0.0f, 0.0f}) exr.image.pixels.push_back(value);
    write_exr(folder / "valid.exr", exr);
    return file_bytes(folder / "valid.exr");
}

std::string with_display_window(std::string exr, int min_x, int min_y, int max_x, int max_y) {
    const std::string window = little_endian(min_x) + little_endian(min_y) + little_endian(max_x) + little_endian(max_y);
    const std::string name("displayWindow\0box2i\0\x10\0\0\0", 24);
    return exr.replace(exr.find(name) + name.size(), window.size(), window);
}

TEST(ForeignExr, DisplayWindowIsWhatCounts) {
    const TestFolder folder;
    const std::string valid = exr_file(folder);
    const auto read = [&](int min_x, int min_y, int max_x, int max_y) {
        ExrFile exr = read_exr(folder.write("a.exr", with_display_window(valid, min_x, min_y, max_x, max_y)));
        EXPECT_EQ(exr.image.width, static_cast<uint32_t>(max_x - min_x + 1));
        EXPECT_EQ(exr.image.height, static_cast<uint32_t>(max_y - min_y + 1));
        Numbers red;
        for (size_t i = 0; i < exr.image.pixels.size(); i += 3) red.push_back(exr.image.pixels[i]);
        EXPECT_EQ(red, exr.channels["Z"]);
        return std::pair(red, exr.is_complete);
    };
    EXPECT_EQ(read(0, 0, 2, 1), std::pair(Numbers{1, 2, 3, 4, 5, 6}, true));
    EXPECT_EQ(read(1, 0, 1, 1), std::pair(Numbers{2, 5}, true)) << "overscan is cut off";
    EXPECT_EQ(read(-1, -1, 1, 0), std::pair(Numbers{0, 0, 0, 0, 1, 2}, false)) << "the lower right part";
    EXPECT_EQ(read(2, 1, 3, 2), std::pair(Numbers{6, 0, 0, 0}, false)) << "the upper left part";
    EXPECT_EQ(read(100, -50, 101, -50), std::pair(Numbers{0, 0}, false)) << "no common pixel";
    EXPECT_EQ(read(1 << 29, 1 << 29, 1 << 29, 1 << 29), std::pair(Numbers{0}, false));

    const auto refuse = [&](int max_x, int max_y, const std::string& words) {
        EXPECT_USER_ERROR(read_exr(folder.write("a.exr", with_display_window(valid, 0, 0, max_x, max_y))), words);
    };
    refuse(20000, 1, "20001 x 2 pixels");
    refuse(-1, 1, "damaged or unsupported");
    refuse(16383, 16383, "its pixels need 4096 MiB");
    // A black border would count as an error of the render, or as its samples.
    folder.write("a.exr", with_display_window(valid, -1, 0, 2, 1));
    EXPECT_USER_ERROR(read_reference(folder / "a.exr"), "lacks pixels of its display window");
    EXPECT_USER_ERROR(read_film(folder / "a.exr"), "lacks pixels of its display window");
}

TEST(ForeignExr, ChannelsOfIntegersAreLeftOut) {
    const TestFolder folder;
    std::string file = exr_file(folder);
    const size_t type_of_z = file.find(std::string("Z\0\2\0\0\0", 6)) + 2;
    const ExrFile exr = read_exr(folder.write("a.exr", file.replace(type_of_z, 1, 1, '\0')));
    EXPECT_EQ(exr.image.pixels[3], 2);
    EXPECT_TRUE(exr.channels.empty());
    EXPECT_USER_ERROR(read_exr(folder.write("a.exr", file.replace(type_of_z, 1, 1, '\7'))), "damaged or unsupported");
}

TEST(ForeignExr, CompressionsThatAreNotReadHaveNames) {
    const TestFolder folder;
    std::string file = exr_file(folder);
    const std::string name("compression\0compression\0\1\0\0\0", 28);
    const size_t compression = file.find(name) + name.size();
    const std::pair<int, const char*> names[] = {{5, "PXR24"}, {6, "B44"}, {7, "B44A"}, {8, "DWAA"}, {9, "DWAB"}};
    for (const auto& [number, text] : names) {
        file[compression] = static_cast<char>(number);
        EXPECT_USER_ERROR(read_exr(folder.write("a.exr", file)),
                          "its compression (" + std::string(text) + ") is not read: export it with ZIP, PIZ, RLE or none");
    }
    file[compression] = 77;
    EXPECT_USER_ERROR(read_exr(folder.write("a.exr", file)), "damaged or unsupported");
}

// Among them channels of integers beside three of 16-bit floats.
TEST(ForeignExr, SeedsOfTheFuzzerAreRead) {
    for (const auto& seed : std::filesystem::directory_iterator(project_folder() / "tests/fuzz/seeds/exr"))
        EXPECT_NO_THROW(read_exr(seed.path())) << seed.path();
}

TEST(ForeignExr, OtherPrimariesHaveANote) {
    const TestFolder folder;
    std::string file = exr_file(folder);
    const std::string name("padding\0string\0\x40\0\0\0", 19);
    const auto count_notes = [&](const Numbers& chromaticities) {
        std::string attribute("chromaticities\0chromaticities\0\x20\0\0\0", 34);
        for (const float number : chromaticities) attribute += little_endian(number);
        std::string changed = file;
        const size_t begin = file.find(name);
        // The file keeps its size, so that the offsets of its blocks stay right.
        const std::string padding = "x" + std::string(1, '\0') + "string" + std::string(1, '\0');
        const size_t padded = name.size() + 64 - attribute.size() - padding.size() - 4;
        attribute += padding + little_endian(static_cast<uint32_t>(padded)) + std::string(padded, ' ');
        std::vector<std::string> notes;
        read_radiance(folder.write("a.exr", changed.replace(begin, name.size() + 64, attribute)), notes);
        return notes.size();
    };
    EXPECT_EQ(count_notes({0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f}), 0u);
    EXPECT_EQ(count_notes({0.713f, 0.293f, 0.165f, 0.83f, 0.128f, 0.044f, 0.32168f, 0.33767f}), 1u);
}

}  // namespace
}  // namespace lab
