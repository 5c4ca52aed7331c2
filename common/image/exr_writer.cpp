// Writes OpenEXR files: 32-bit floats in scan lines, in blocks of 16 rows that all threads compress (tinyexr's writer is
// single-threaded).
#include <algorithm>
#include <cstring>

#include "image/encoding.h"
#include "image/image.h"
#include "parallel.h"

namespace lab {
namespace {

constexpr uint32_t rows_per_block = 16;

// A channel in memory: element i is first[i * stride].
struct Plane {
    const float* first;
    size_t stride;
};
using Planes = std::map<std::string, Plane>;  // sorted by name, as OpenEXR demands

std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
    return name + '\0' + type + '\0' + little_endian(static_cast<uint32_t>(value.size())) + value;
}

std::string header(const ExrFile& exr, const Planes& planes) {
    const std::string zero(1, '\0');
    std::string channels;
    for (const auto& [name, plane] : planes)  // 32-bit floats, one per pixel
        channels += name + zero + little_endian(2) + little_endian(0) + little_endian(1) + little_endian(1);
    const std::string window =
        little_endian(0) + little_endian(0) + little_endian(exr.image.width - 1) + little_endian(exr.image.height - 1);
    std::string text("\x76\x2f\x31\x01\x02\0\0\0", 8);  // magic number and version 2: scan lines
    text += attribute("channels", "chlist", channels + zero);
    text += attribute("compression", "compression", "\x03");  // ZIP
    text += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window);
    text += attribute("lineOrder", "lineOrder", zero);
    text += attribute("pixelAspectRatio", "float", little_endian(1.0f));
    text += attribute("screenWindowCenter", "v2f", little_endian(0.0f) + little_endian(0.0f));
    text += attribute("screenWindowWidth", "float", little_endian(1.0f));
    for (const auto& [name, value] : exr.attributes) text += attribute(name, "string", value);
    return text + zero;
}

// OpenEXR's ZIP predictor: even bytes before odd ones, differences of neighbours, zlib. Never longer than the input.
std::string compress_block(const std::string& rows) {
    std::string split(rows.size(), '\0');
    const size_t half = (rows.size() + 1) / 2;
    for (size_t i = 0; i < rows.size(); ++i) split[(i % 2 ? half : 0) + i / 2] = rows[i];
    for (size_t i = split.size(); i-- > 1;) split[i] = static_cast<char>(split[i] - split[i - 1] + 128);
    std::string packed = compress_numbers(split);
    return packed.size() < rows.size() ? packed : rows;
}

}  // namespace

void write_exr(const std::filesystem::path& file, const ExrFile& exr) {
    const size_t width = exr.image.width, height = exr.image.height;
    Planes planes;
    for (size_t channel = 0; channel < 3; ++channel)
        planes[std::string(1, "RGB"[channel])] = {exr.image.pixels.data() + channel, 3};
    for (const auto& [name, numbers] : exr.channels) planes[name] = {numbers.data(), 1};

    std::vector<std::string> blocks((height + rows_per_block - 1) / rows_per_block);
    in_parallel(height, rows_per_block, [&](size_t begin, size_t end) {
        std::string rows((end - begin) * planes.size() * width * sizeof(float), '\0');
        char* target = rows.data();
        for (size_t y = begin; y < end; ++y)
            for (const auto& [name, plane] : planes)
                for (size_t x = 0; x < width; ++x, target += sizeof(float))
                    std::memcpy(target, plane.first + (y * width + x) * plane.stride, sizeof(float));
        const std::string packed = compress_block(rows);
        blocks[begin / rows_per_block] =
            little_endian(static_cast<uint32_t>(begin)) + little_endian(static_cast<uint32_t>(packed.size())) + packed;
    });
    std::string start = header(exr, planes);
    uint64_t offset = start.size() + blocks.size() * sizeof offset;
    for (const std::string& block : blocks) {
        start += little_endian(offset);
        offset += block.size();
    }
    std::vector<std::string_view> parts(blocks.begin(), blocks.end());
    parts.insert(parts.begin(), start);
    write_file(file, parts);
}

}  // namespace lab
