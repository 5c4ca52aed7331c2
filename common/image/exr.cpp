// Reads OpenEXR with tinyexr, behind checks: damaged headers make it abort or allocate without bound.
#include <tinyexr.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <memory>

#include "error.h"
#include "files/file.h"
#include "image/image.h"
#include "image/image_checks.h"
#include "parallel.h"

namespace lab {
namespace {

// Throws tinyexr's message, if there is one, as a UserError.
[[noreturn]] void fail_with(const std::filesystem::path& file, const char* message) {
    std::string reason = message ? message : "cannot be decoded";
    FreeEXRErrorMessage(message);
    fail(file, "damaged or unsupported OpenEXR file: " + reason.substr(0, reason.find('\n')));
}

// Walks over the attributes (name, type, size, value) to check "type": tinyexr aborts on unknown values.
void check_attributes(const std::filesystem::path& file, std::string_view bytes) {
    bytes.remove_prefix(8);  // magic number and version
    const auto take_string = [&] { return take_until('\0', file, bytes); };
    for (std::string_view name = take_string(); !name.empty(); name = take_string()) {
        take_string();  // type
        uint32_t size = 0;
        if (bytes.size() >= sizeof size) std::memcpy(&size, bytes.data(), sizeof size);
        if (bytes.size() < sizeof size + size) fail_truncated(file);
        const std::string_view value = bytes.substr(sizeof size, size);
        if (name == "type" && value.substr(0, value.find('\0')) != "scanlineimage")
            fail(file, "only flat OpenEXR images of scan lines are read");
        bytes.remove_prefix(sizeof size + size);
    }
}

// Checks that sizes are within the limits and the file, and that every channel covers the whole image.
void check_header(const std::filesystem::path& file, const EXRHeader& header, uint64_t file_size) {
    const EXRBox2i& window = header.data_window;
    const int64_t width = int64_t{window.max_x} - window.min_x + 1;
    const int64_t height = int64_t{window.max_y} - window.min_y + 1;
    check_image_size(file, width, height);
    if (std::abs(int64_t{window.min_x}) > max_image_extent || std::abs(int64_t{window.min_y}) > max_image_extent)
        fail(file, "its data window is too far from the origin");
    constexpr int max_channels = 64;
    if (header.num_channels > max_channels) fail(file, "it has more than 64 channels");
    uint64_t bytes_per_pixel = 0;
    for (int i = 0; i < header.num_channels; ++i) {
        const EXRChannelInfo& channel = header.channels[i];
        if (channel.pixel_type != TINYEXR_PIXELTYPE_HALF && channel.pixel_type != TINYEXR_PIXELTYPE_FLOAT)
            fail(file, "channel " + in_quotes(channel.name) + " must hold 16 or 32-bit floats");
        if (channel.x_sampling != 1 || channel.y_sampling != 1)
            fail(file, "channel " + in_quotes(channel.name) + " must have a value for every pixel");
        bytes_per_pixel += channel.pixel_type == TINYEXR_PIXELTYPE_HALF ? 2 : 4;
    }
    if (static_cast<uint64_t>(width * height) * bytes_per_pixel > max_deflate_ratio * file_size) fail_truncated(file);
    check_memory(file, static_cast<uint64_t>(width * height) * 3 * sizeof(float), file_size);
}

// Moves the decoded planes into an ExrFile.
ExrFile collect(const std::filesystem::path& file, const EXRHeader& header, const EXRImage& decoded) {
    ExrFile exr;
    exr.image.width = static_cast<uint32_t>(decoded.width);
    exr.image.height = static_cast<uint32_t>(decoded.height);
    const size_t pixel_count = static_cast<size_t>(decoded.width) * decoded.height;
    std::array<const float*, 3> colours{};
    for (int i = 0; i < header.num_channels; ++i) {
        const auto* plane = reinterpret_cast<const float*>(decoded.images[i]);
        const std::string name = header.channels[i].name;
        if (name == "R" || name == "G" || name == "B")
            colours[std::string("RGB").find(name)] = plane;
        else
            exr.channels[name].assign(plane, plane + pixel_count);
    }
    if (std::ranges::count(colours, nullptr) > 0) fail(file, "it needs the channels R, G and B");
    exr.image.pixels.resize(3 * pixel_count);
    in_parallel(pixel_count, 1 << 16, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            for (size_t channel = 0; channel < 3; ++channel) exr.image.pixels[3 * i + channel] = colours[channel][i];
    });
    for (int i = 0; i < header.num_custom_attributes; ++i) {
        const EXRAttribute& attribute = header.custom_attributes[i];
        if (std::string_view(attribute.type) != "string") continue;
        std::string value(reinterpret_cast<const char*>(attribute.value), static_cast<size_t>(attribute.size));
        if (value == std::string(1, '\0')) value.clear();  // tinyexr's empty string
        exr.attributes[attribute.name] = value;
    }
    return exr;
}

}  // namespace

ExrFile read_exr(const std::filesystem::path& file) {
    std::string bytes = read_file(file, max_image_file_bytes);
    const size_t size = bytes.size();
    if (size < 8 || !bytes.starts_with("\x76\x2f\x31\x01")) fail(file, "not an OpenEXR file");
    check_attributes(file, bytes);
    // tinyexr reads PIZ tables of up to 8 KiB past the end of the file: append zeros.
    bytes.resize(size + 16384);
    const auto* memory = reinterpret_cast<const unsigned char*>(bytes.data());
    try {
        EXRVersion version;
        if (ParseEXRVersionFromMemory(&version, memory, size) != TINYEXR_SUCCESS || version.tiled || version.multipart ||
            version.non_image)
            fail(file, "only single-part OpenEXR images of scan lines are read");
        EXRHeader header;
        InitEXRHeader(&header);
        const std::unique_ptr<EXRHeader, decltype(&FreeEXRHeader)> frees_header(&header, FreeEXRHeader);
        const char* message = nullptr;
        if (ParseEXRHeaderFromMemory(&header, &version, memory, size, &message) != TINYEXR_SUCCESS) fail_with(file, message);
        check_header(file, header, size);
        std::fill_n(header.requested_pixel_types, header.num_channels, TINYEXR_PIXELTYPE_FLOAT);
        header.chunk_count = 0;  // makes tinyexr compute it instead of allocating what the file claims
        header.line_order = 0;   // rows carry their number; tinyexr would flip decreasing ones
        EXRImage decoded;
        InitEXRImage(&decoded);
        const std::unique_ptr<EXRImage, decltype(&FreeEXRImage)> frees_image(&decoded, FreeEXRImage);
        decoded.num_channels = header.num_channels;  // or else tinyexr leaks the planes if it fails
        if (LoadEXRImageFromMemory(&decoded, &header, memory, size, &message) != TINYEXR_SUCCESS) {
            InitEXRImage(&decoded);  // on failure tinyexr has freed it
            fail_with(file, message);
        }
        return collect(file, header, decoded);
    } catch (const UserError&) {
        throw;
    } catch (const std::exception& error) {
        fail(file, std::string("damaged OpenEXR file: ") + error.what());
    }
}

}  // namespace lab
