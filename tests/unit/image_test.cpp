// Image files: written files read back unchanged, damaged ones are refused with one line.
#include "image/image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "files/file.h"
#include "image/encoding.h"
#include "image/image_checks.h"
#include "test_files.h"

namespace lab {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

Image random_image(uint32_t width, uint32_t height) {
    std::mt19937 random(1);
    std::lognormal_distribution<float> radiance(0, 3);
    Image image{width, height, {}};
    for (size_t i = 0; i < 3 * size_t{width} * height; ++i) image.pixels.push_back(radiance(random));
    return image;
}

Image radiance_of(const std::filesystem::path& file) {
    std::vector<std::string> notes;
    Image image = read_radiance(file, notes);
    EXPECT_TRUE(notes.empty());
    return image;
}

Texture gradient_texture(uint32_t width, uint32_t height) {
    Texture texture{width, height, {}};
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x)
            for (const uint32_t value : {2 * x, 3 * y, x + y, 255u}) texture.pixels.push_back(static_cast<uint8_t>(value));
    return texture;
}

// Replaces bytes of a header, to make files that our writers cannot make.
std::string patched(std::string bytes, size_t position, const std::string& replacement) {
    return bytes.replace(position, replacement.size(), replacement);
}

// An uncompressed 2 x 2 image with rows from the bottom, as in .bmp files.
std::string bmp_bytes() {
    std::string bytes = "BM";
    const auto add = [&](uint32_t value, int count) {
        for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 255);
    };
    for (const uint32_t value : {70u, 0u, 54u, 40u, 2u, 2u}) add(value, 4);
    add(1, 2), add(24, 2);
    for (const uint32_t value : {0u, 16u, 0u, 0u, 0u, 0u}) add(value, 4);
    for (const uint32_t bgr : {0x0000ffu, 0x00ff00u}) add(bgr, 3);  // bottom row: blue, green
    add(0, 2);
    for (const uint32_t bgr : {0xff0000u, 0xffffffu}) add(bgr, 3);  // top row: red, white
    add(0, 2);
    return bytes;
}

std::string tga_bytes() {
    const char header[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, 24, 0x20};  // rows from the top
    return std::string(header, sizeof header) + std::string("\x00\x00\xff\xff\xff\xff\xff\x00\x00\x00\xff\x00", 12);
}

TEST(Srgb, KnownValues) {
    EXPECT_EQ(linear_to_srgb(0), 0);
    EXPECT_EQ(linear_to_srgb(1), 1);
    // Where the two pieces of the curve nearly meet.
    EXPECT_NEAR(linear_to_srgb(0.0031307f), 12.92 * 0.0031307, 4e-9);
    EXPECT_NEAR(linear_to_srgb(0.0031309f), 1.055 * std::pow(0.0031309, 1 / 2.4) - 0.055, 4e-9);
    EXPECT_FLOAT_EQ(linear_to_srgb(0.02f), static_cast<float>(1.055 * std::pow(0.02f, 1 / 2.4) - 0.055));
    EXPECT_FLOAT_EQ(linear_to_srgb(0.5f), 0.7353569831f);
}

TEST(Srgb, ClampsToTheUnitInterval) {
    EXPECT_EQ(linear_to_srgb(-1), 0);
    EXPECT_EQ(linear_to_srgb(7), 1);
    EXPECT_EQ(linear_to_srgb(infinity), 1);
}

TEST(Exr, RoundTripIsExact) {
    const TestFolder folder;
    constexpr size_t pixel_count = size_t{33} * 49;
    ExrFile written{random_image(33, 49), {}, {}};
    written.image.pixels[0] = -0.0f;
    written.image.pixels[1] = std::numeric_limits<float>::denorm_min();
    written.image.pixels[2] = -infinity;
    written.channels["A.before_all"] = std::vector<float>(pixel_count, 0.25f);
    written.channels["compensation.R"] = std::vector<float>(pixel_count, 1e-30f);
    written.channels["samples"] = random_image(11, 49).pixels;
    written.attributes = {{"empty", ""}, {"samples", "64"}, {"device", "a device, with (punctuation)"}};
    write_exr(folder / "a.exr", written);
    const ExrFile read = read_exr(folder / "a.exr");
    EXPECT_EQ(read.image.width, 33u);
    EXPECT_EQ(read.image.height, 49u);
    ASSERT_EQ(read.image.pixels.size(), written.image.pixels.size());
    for (size_t i = 0; i < read.image.pixels.size(); ++i)
        EXPECT_EQ(std::bit_cast<uint32_t>(read.image.pixels[i]), std::bit_cast<uint32_t>(written.image.pixels[i]));
    EXPECT_EQ(read.channels, written.channels);
    EXPECT_EQ(read.attributes, written.attributes);
    EXPECT_EQ(folder.file_count(), 1u) << "a temporary file was left behind";
}

// Deflate makes noise larger, and a little black smaller: in between, a block gets exactly the size that it had.
TEST(Exr, BlocksThatCompressionLeavesAtTheirSizeAreKept) {
    const TestFolder folder;
    std::mt19937 random(1);
    for (size_t black = 0; black < 12; ++black)
        for (int repetition = 0; repetition < 20; ++repetition) {
            ExrFile written{{16, 16, std::vector<float>(3 * 16 * 16)}, {}, {}};
            for (float& number : written.image.pixels) number = std::bit_cast<float>(static_cast<uint32_t>(random()));
            std::ranges::fill_n(written.image.pixels.begin(), static_cast<std::ptrdiff_t>(3 * black), 0.0f);
            write_exr(folder / "a.exr", written);
            const ExrFile read = read_exr(folder / "a.exr");
            EXPECT_EQ(std::memcmp(read.image.pixels.data(), written.image.pixels.data(), 3 * 16 * 16 * sizeof(float)), 0)
                << black;
        }
}

TEST(Exr, ChannelsAreSortedByNameInTheFile) {
    const TestFolder folder;
    ExrFile exr{random_image(2, 2), {}, {}};
    for (const char* name : {"z", "A", "H", "a"}) exr.channels[name] = {1, 2, 3, 4};
    write_exr(folder / "a.exr", exr);
    const std::string bytes = file_bytes(folder / "a.exr");
    size_t position = bytes.find("chlist") + 7 + 4;
    std::string names;
    for (; bytes[position] != 0; position += 2 + 16) names += bytes[position];
    EXPECT_EQ(names, "ABGHRaz");
}

TEST(Exr, NanAndInfinityAreKeptButAreNoRadiance) {
    const TestFolder folder;
    for (const float bad : {std::nanf(""), infinity, -0.5f}) {
        ExrFile exr{random_image(4, 4), {}, {}};
        exr.image.pixels[3 * 6 + 1] = bad;  // pixel (2, 1)
        write_exr(folder / "a.exr", exr);
        EXPECT_NO_THROW(read_exr(folder / "a.exr"));
        EXPECT_USER_ERROR(radiance_of(folder / "a.exr"), "pixel (2, 1)");
    }
}

TEST(Exr, RefusesDamagedHeaders) {
    const TestFolder folder;
    write_exr(folder / "a.exr", {random_image(40, 40), {}, {{"chunkCoun_", "lots"}}});
    const std::string valid = file_bytes(folder / "a.exr");
    const auto read = [&](const std::string& bytes) { read_exr(folder.write("b.exr", bytes)); };
    EXPECT_USER_ERROR(read("v/1 no such thing"), "not an OpenEXR file");
    EXPECT_USER_ERROR(read(patched(valid, 5, "\x02")), "damaged or unsupported");  // tiled
    EXPECT_USER_ERROR(read(patched(valid, valid.find("scanlineimage"), "scanlineimagE")), "damaged or unsupported");
    EXPECT_USER_ERROR(read(patched(valid, valid.find("chunkCoun_"), "chunkCount")), "damaged or unsupported");
    // 16384 x 16384 pixels do not fit into these few bytes; 40 x 16385 and negative sizes are never allowed.
    const size_t window = valid.find("box2i") + 6 + 4;
    EXPECT_USER_ERROR(read(patched(valid, window + 8, std::string("\xff\x3f\0\0\xff\x3f\0\0", 8))), "ends too early");
    EXPECT_USER_ERROR(read(patched(valid, window + 12, std::string("\x00\x40\0\0", 4))), "40 x 16385");
    EXPECT_USER_ERROR(read(patched(valid, window + 8, std::string("\xf0\xff\xff\xff", 4))), "damaged or unsupported");
    // Channels with only every second pixel.
    const size_t channel = valid.find("chlist") + 7 + 4 + 2;
    EXPECT_USER_ERROR(read(patched(valid, channel + 8, "\x02")), "a value for every pixel");
    EXPECT_USER_ERROR(read(patched(valid, channel, std::string(1, '\0'))), "16 or 32-bit floats");
    EXPECT_USER_ERROR(read(patched(valid, channel - 2, "X")), "R, G and B");
}

// From such a block OpenEXR's C++ classes (3.1) take pixels that nobody wrote.
TEST(Exr, RefusesBlocksThatAreTooShort) {
    const TestFolder folder;
    write_exr(folder / "a.exr", {{40, 16, std::vector<float>(3 * 40 * 16, 0.5f)}, {}, {}});
    const std::string valid = file_bytes(folder / "a.exr");
    size_t table = 0;  // of a single block, which follows it: its row, its size, its bytes
    while (!valid.substr(table).starts_with(little_endian(uint64_t{table + 8}))) ++table;
    for (const uint32_t size : {0u, 12u})
        EXPECT_USER_ERROR(read_exr(folder.write("b.exr", patched(valid, table + 12, little_endian(size)))), "damaged");
    std::string uncompressed = patched(valid, table + 12, little_endian(uint32_t{12}));
    uncompressed[uncompressed.find("compression", uncompressed.find("compression") + 1) + 16] = 0;
    EXPECT_USER_ERROR(read_exr(folder.write("b.exr", uncompressed)), "damaged");
}

TEST(Hdr, RoundTripWithinTheSharedExponent) {
    const TestFolder folder;
    for (const uint32_t width : {1u, 7u, 8u, 200u}) {  // not run-length encoded below 8
        Image written = random_image(width, 5);
        if (width > 100) std::fill_n(written.pixels.begin(), 300, 0.75f);  // a run
        write_hdr(folder / "a.hdr", written);
        const Image read = radiance_of(folder / "a.hdr");
        ASSERT_EQ(read.width, width);
        ASSERT_EQ(read.height, 5u);
        for (size_t i = 0; i < written.pixels.size(); i += 3) {
            const float largest = *std::max_element(&written.pixels[i], &written.pixels[i] + 3);
            for (size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(read.pixels[i + c], written.pixels[i + c], largest / 127) << width << " " << i;
        }
    }
}

TEST(Hdr, ExactValuesAndUnrepresentableOnes) {
    const TestFolder folder;
    write_hdr(folder / "a.hdr", {2, 1, {1, 0.5f, 0, -3, std::nanf(""), infinity}});
    const Image read = radiance_of(folder / "a.hdr");
    EXPECT_EQ(std::vector<float>(read.pixels.begin(), read.pixels.begin() + 5), (std::vector<float>{1, 0.5f, 0, 0, 0}));
    EXPECT_GT(read.pixels[5], 9e37f);
    EXPECT_LT(read.pixels[5], infinity);
}

TEST(Hdr, RefusesWhatItCannotRead) {
    const TestFolder folder;
    const auto read = [&](const std::string& bytes) { radiance_of(folder.write("a.hdr", bytes)); };
    EXPECT_USER_ERROR(read("GIF89a"), "not a Radiance");
    EXPECT_USER_ERROR(read("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n"), "32-bit_rle_rgbe");
    EXPECT_USER_ERROR(read("#?RADIANCE\n\n+Y 4 +X 4\n"), "rows from the top");
    EXPECT_USER_ERROR(read("#?RADIANCE\n\n-Y ? +X 4\n"), "width and height");
    EXPECT_USER_ERROR(read("#?RADIANCE\n\n-Y 20000 +X 4\n"), "20000");
    EXPECT_USER_ERROR(read("#?RADIANCE\n\n-Y 0 +X 4\n"), "4 x 0");
    EXPECT_USER_ERROR(read("#?RADIANCE\n\n-Y 16384 +X 16384\nxxxx"), "ends too early");
    const std::string head = "#?RADIANCE\n\n-Y 1 +X 8\n";
    EXPECT_USER_ERROR(read(head + std::string("\x02\x02\0\x08\0\0\0\0", 8)), "run-length");      // no progress
    EXPECT_USER_ERROR(read(head + std::string("\x02\x02\0\x08\xff\x01\0\0", 8)), "run-length");  // 127 of 8
}

TEST(Textures, PngRoundTripIsExact) {
    const TestFolder folder;
    const Texture smooth = gradient_texture(61, 43);
    Texture noise = smooth;  // the distances to the neighbours are now and then equal
    std::mt19937 random(1);
    for (uint8_t& byte : noise.pixels) byte = static_cast<uint8_t>(random() % 16);
    for (const Texture& written : {smooth, noise}) {
        write_png(folder / "a.png", written);
        const Texture read = read_texture(folder / "a.png");
        EXPECT_EQ(read.width, 61u);
        EXPECT_EQ(read.height, 43u);
        EXPECT_EQ(read.pixels, written.pixels);
    }
}

TEST(Textures, JpgIsClose) {
    const TestFolder folder;
    const Texture written = gradient_texture(61, 43);
    write_jpg(folder / "a.jpg", written);
    const Texture read = read_texture(folder / "a.jpg");
    ASSERT_EQ(read.pixels.size(), written.pixels.size());
    double difference = 0;
    for (size_t i = 0; i < read.pixels.size(); ++i) difference += std::abs(read.pixels[i] - written.pixels[i]);
    EXPECT_LT(difference / static_cast<double>(read.pixels.size()), 3);
}

TEST(Textures, BmpAndTgaStartWithTheTopRow) {
    const TestFolder folder;
    const std::vector<uint8_t> red_white_blue_green = {255, 0, 0, 255, 255, 255, 255, 255, 0, 0, 255, 255, 0, 255, 0, 255};
    EXPECT_EQ(read_texture(folder.write("a.bmp", bmp_bytes())).pixels, red_white_blue_green);
    EXPECT_EQ(read_texture(folder.write("a.tga", tga_bytes())).pixels, red_white_blue_green);
}

TEST(Textures, RefusesOtherFilesAndImpossibleSizes) {
    const TestFolder folder;
    const auto read = [&](const std::string& bytes) { read_texture(folder.write("a.png", bytes)); };
    EXPECT_USER_ERROR(read("no image at all"), "not a texture");
    write_hdr(folder / "a.hdr", random_image(9, 9));
    EXPECT_USER_ERROR(read_texture(folder / "a.hdr"), "not a texture");
    write_png(folder / "b.png", gradient_texture(20, 20));
    const std::string valid = file_bytes(folder / "b.png");
    EXPECT_USER_ERROR(read(patched(valid, 16, std::string("\0\0\x40\x01", 4))), "16385");
    EXPECT_USER_ERROR(read(patched(valid, 16, std::string("\0\0\x40\0\0\0\x40\0", 8))), "ends too early");
    EXPECT_USER_ERROR(read(tga_bytes().substr(0, 29)), "ends too early");
    EXPECT_USER_ERROR(read(bmp_bytes().substr(0, 65)), "ends too early");
}

TEST(ImageFiles, PathsThatCannotBeRead) {
    const TestFolder folder;
    for (const auto& read : std::initializer_list<std::function<void(const std::filesystem::path&)>>{
             [](const auto& file) { read_exr(file); }, [](const auto& file) { read_texture(file); }}) {
        EXPECT_USER_ERROR(read(folder / "missing"), "no such file");
        EXPECT_USER_ERROR(read(folder / "."), "not a regular file");
        EXPECT_USER_ERROR(read(folder.write("empty", "")), "empty");
    }
    EXPECT_USER_ERROR(radiance_of(folder / "a.png"), ".hdr or .exr");
    folder.write("large", "");
    std::filesystem::resize_file(folder / "large", max_image_file_bytes + 1);  // sparse: needs no space
    EXPECT_USER_ERROR(read_texture(folder / "large"), "limit");
}

TEST(ImageFiles, DamagedFilesAreRefusedOrRead) {
    const TestFolder folder;
    write_exr(folder / "valid.exr", {random_image(30, 40), {{"samples", random_image(10, 40).pixels}}, {{"a", "b"}}});
    write_hdr(folder / "valid.hdr", random_image(30, 40));
    write_png(folder / "valid.png", gradient_texture(40, 30));
    write_jpg(folder / "valid.jpg", gradient_texture(40, 30));
    const auto radiance = [](const auto& file) { radiance_of(file); };
    const auto texture = [](const auto& file) { read_texture(file); };
    damage(folder, "a.exr", file_bytes(folder / "valid.exr"), true, radiance);
    damage(folder, "a.hdr", file_bytes(folder / "valid.hdr"), true, radiance);
    damage(folder, "a.png", file_bytes(folder / "valid.png"), true, texture);
    damage(folder, "a.jpg", file_bytes(folder / "valid.jpg"), true, texture);
    damage(folder, "a.bmp", bmp_bytes(), false, texture);
    damage(folder, "a.tga", tga_bytes(), false, texture);
}

TEST(WriteFile, NeedsAFolder) {
    const TestFolder folder;
    EXPECT_USER_ERROR(write_png(folder / "missing/a.png", gradient_texture(2, 2)), "cannot be written");
    std::filesystem::create_directory(folder / "a.png");
    EXPECT_USER_ERROR(write_png(folder / "a.png", gradient_texture(2, 2)), "cannot be written");
    EXPECT_EQ(folder.file_count(), 1u);
}

TEST(CheckWritable, CreatesFoldersAndKeepsFiles) {
    const TestFolder folder;
    EXPECT_NO_THROW(check_writable(folder / "new/folders/a.EXR"));
    EXPECT_TRUE(std::filesystem::is_directory(folder / "new/folders"));
    EXPECT_TRUE(std::filesystem::is_empty(folder / "new/folders"));
    folder.write("a.png", "contents");
    EXPECT_NO_THROW(check_writable(folder / "a.png"));
    EXPECT_EQ(file_bytes(folder / "a.png"), "contents");
}

TEST(CheckWritable, RefusesWhatCannotBeWritten) {
    const TestFolder folder;
    for (const char* name : {"a", "a.gif", "a.exr.txt", ".png"})
        EXPECT_USER_ERROR(check_writable(folder / name), "must end in .exr, .hdr, .png or .jpg");
    std::filesystem::create_directory(folder / "folder.png");
    EXPECT_USER_ERROR(check_writable(folder / "folder.png"), "folder");
    folder.write("file", "");
    EXPECT_USER_ERROR(check_writable(folder / "file/a.png"), "folder cannot be created");
    EXPECT_USER_ERROR(check_writable(folder / (std::string(300, 'x') + ".png")), "cannot be written");
}

TEST(InQuotes, NamesAreSafeToPrint) {
    EXPECT_EQ(in_quotes("steel"), "\"steel\"");
    EXPECT_EQ(in_quotes("a\x1b[31m\nb"), "\"a?[31m?b\"");
    EXPECT_EQ(in_quotes(std::string(1000, 'x')).size(), 85u);
}

}  // namespace
}  // namespace lab
