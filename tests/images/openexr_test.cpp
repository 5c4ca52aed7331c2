// Our OpenEXR reader, which uses the C interface of the format's authors, against their C++ classes, which write files of every
// construct that we accept.
#include <ImathBox.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>
#include <half.h>

#include <random>

#include "error.h"
#include "image/image.h"
#include "tests/support/temporary_folder.h"

namespace lab {
namespace {

using Imath::Box2i, Imath::V2i;

// A file of 32-bit floats, of 16-bit floats or of both, beside a channel of integers. Its numbers are all 16-bit floats.
struct Construct {
    Imf::Compression compression;
    Imf::LineOrder order;
    Imf::PixelType colours, depth;
    Box2i data, display;
};

// Pixels of the data window, one plane for each channel.
std::map<std::string, std::vector<float>> random_planes(const Box2i& window) {
    std::mt19937 random(1);
    std::map<std::string, std::vector<float>> planes;
    for (const char* name : {"R", "G", "B", "Z", "id"}) {
        auto& plane = planes[name];
        for (int i = 0; i < (window.size().x + 1) * (window.size().y + 1); ++i)
            plane.push_back(half(static_cast<float>(random() % 4 ? random() % 100 : i / 20)));  // runs, too
    }
    return planes;
}

void write(const std::filesystem::path& file, const Construct& construct,
           const std::map<std::string, std::vector<float>>& planes) {
    Imf::Header header(construct.display, construct.data);
    header.compression() = construct.compression;
    header.lineOrder() = construct.order;
    Imf::FrameBuffer buffer;
    std::map<std::string, std::vector<char>> memory;
    const int width = construct.data.size().x + 1;
    for (const auto& [name, plane] : planes) {
        const Imf::PixelType type = name == "id" ? Imf::UINT : name == "Z" ? construct.depth : construct.colours;
        const size_t size = type == Imf::HALF ? 2 : 4;
        auto& bytes = memory[name];
        bytes.resize(plane.size() * size);
        for (size_t i = 0; i < plane.size(); ++i) {
            const half number(plane[i]);
            const auto integer = static_cast<unsigned>(plane[i]);
            const void* source = type == Imf::HALF   ? static_cast<const void*>(&number)
                                 : type == Imf::UINT ? static_cast<const void*>(&integer)
                                                     : &plane[i];
            std::memcpy(bytes.data() + i * size, source, size);
        }
        header.channels().insert(name, Imf::Channel(type));
        // OpenEXR wants the address of pixel (0, 0).
        const ptrdiff_t first = (ptrdiff_t{construct.data.min.y} * width + construct.data.min.x) * static_cast<ptrdiff_t>(size);
        buffer.insert(name, Imf::Slice(type, bytes.data() - first, size, size * static_cast<size_t>(width)));
    }
    Imf::OutputFile output(file.string().c_str(), header);
    output.setFrameBuffer(buffer);
    const int rows = construct.data.size().y + 1;
    if (construct.order == Imf::DECREASING_Y)
        for (int i = 0; i < rows; ++i) output.writePixels(1);
    else
        output.writePixels(rows);
}

float expected(const Construct& construct, const std::vector<float>& plane, size_t row, size_t column) {
    const V2i pixel = construct.display.min + V2i(static_cast<int>(column), static_cast<int>(row)),
              place = pixel - construct.data.min;
    return construct.data.intersects(pixel) ? plane[static_cast<size_t>(place.y * (construct.data.size().x + 1) + place.x)] : 0;
}

TEST(OpenExr, FilesOfEachConstruct) {
    const TemporaryFolder folder;
    const Box2i display(V2i(0, 0), V2i(36, 40)), overscan(V2i(-3, -2), V2i(40, 45)), lower(V2i(0, 20), V2i(36, 40)),
        beside(V2i(-20, -9), V2i(5, 60)), tiny(V2i(7, 7), V2i(7, 7)), elsewhere(V2i(100, 100), V2i(110, 110));
    for (const Imf::Compression compression :
         {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION})
        for (const Imf::LineOrder order : {Imf::INCREASING_Y, Imf::DECREASING_Y})
            for (const auto& [colours, depth] :
                 {std::pair(Imf::HALF, Imf::HALF), {Imf::FLOAT, Imf::FLOAT}, {Imf::HALF, Imf::FLOAT}})
                for (const Box2i& data : {display, overscan, lower, beside, tiny, elsewhere}) {
                    const Construct construct{compression, order, colours, depth, data, display};
                    SCOPED_TRACE(testing::Message() << "compression " << compression << ", order " << order << ", types "
                                                    << colours << depth << ", rows from " << data.min.y);
                    const auto planes = random_planes(data);
                    write(folder.path() / "a.exr", construct, planes);
                    const ExrFile read = read_exr(folder.path() / "a.exr");
                    ASSERT_EQ(read.image.width, 37u);
                    ASSERT_EQ(read.image.height, 41u);
                    ASSERT_EQ(read.channels.size(), 1u);
                    size_t differences = 0;
                    for (size_t row = 0; row < 41; ++row)
                        for (size_t column = 0; column < 37; ++column) {
                            const size_t i = row * 37 + column;
                            const auto differs = [&](const char* name, float number) {
                                return number != expected(construct, planes.at(name), row, column);
                            };
                            differences += differs("R", read.image.pixels[3 * i]) + differs("G", read.image.pixels[3 * i + 1]) +
                                           differs("B", read.image.pixels[3 * i + 2]) + differs("Z", read.channels.at("Z")[i]);
                        }
                    EXPECT_EQ(differences, 0u);
                    EXPECT_EQ(read.is_complete, data == display || data == overscan);
                }
}

TEST(OpenExr, OtherCompressionsAreRefusedByName) {
    const TemporaryFolder folder;
    const Box2i window(V2i(0, 0), V2i(36, 40));
    const std::pair<Imf::Compression, std::string> compressions[] = {{Imf::PXR24_COMPRESSION, "(PXR24)"},
                                                                     {Imf::B44_COMPRESSION, "(B44)"},
                                                                     {Imf::B44A_COMPRESSION, "(B44A)"},
                                                                     {Imf::DWAA_COMPRESSION, "(DWAA)"},
                                                                     {Imf::DWAB_COMPRESSION, "(DWAB)"}};
    for (const auto& [compression, name] : compressions) {
        write(folder.path() / "a.exr", {compression, Imf::INCREASING_Y, Imf::HALF, Imf::HALF, window, window},
              random_planes(window));
        try {
            read_exr(folder.path() / "a.exr");
            FAIL() << name;
        } catch (const UserError& error) {
            EXPECT_PRED_FORMAT2(testing::IsSubstring, name, error.what());
        }
    }
}

}  // namespace
}  // namespace lab
