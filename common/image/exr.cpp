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

void check_compression(const std::filesystem::path& file, size_t compression) {
    constexpr std::array names{"none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"};
    constexpr size_t piz = 4;
    if (compression <= piz) return;
    const std::string name = compression < names.size() ? names[compression] : "number " + std::to_string(compression);
    fail(file, "its compression (" + name + ") is not read: export it with ZIP, PIZ, RLE or none");
}

// Walks over the attributes (name, type, size, value) to check two: tinyexr aborts on an unknown "type", and does not name a
// "compression" that it lacks.
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
        if (name == "compression" && !value.empty()) check_compression(file, static_cast<uint8_t>(value[0]));
        bytes.remove_prefix(sizeof size + size);
    }
}

constexpr std::string_view colour_names = "RGB";

// Which of R, G and B a channel is, or npos.
size_t colour_of(const EXRChannelInfo& channel) {
    return std::strlen(channel.name) == 1 ? colour_names.find(channel.name[0]) : std::string_view::npos;
}

int64_t width_of(const EXRBox2i& window) { return int64_t{window.max_x} - window.min_x + 1; }
int64_t height_of(const EXRBox2i& window) { return int64_t{window.max_y} - window.min_y + 1; }

// Checks that sizes are within the limits and the file, and that every channel covers the whole data window.
void check_header(const std::filesystem::path& file, const EXRHeader& header, uint64_t file_size) {
    const EXRBox2i& window = header.data_window;
    const int64_t width = width_of(window), height = height_of(window);
    check_image_size(file, width, height);
    if (std::abs(int64_t{window.min_x}) > max_image_extent || std::abs(int64_t{window.min_y}) > max_image_extent)
        fail(file, "its data window is too far from the origin");
    constexpr int max_channels = 64;
    if (header.num_channels > max_channels) fail(file, "it has more than 64 channels");
    uint64_t bytes_per_pixel = 0;
    for (int i = 0; i < header.num_channels; ++i) {
        const EXRChannelInfo& channel = header.channels[i];
        const bool is_float = channel.pixel_type == TINYEXR_PIXELTYPE_HALF || channel.pixel_type == TINYEXR_PIXELTYPE_FLOAT;
        if (!is_float && (channel.pixel_type != TINYEXR_PIXELTYPE_UINT || colour_of(channel) != std::string_view::npos))
            fail(file, "channel " + in_quotes(channel.name) + " must hold 16 or 32-bit floats");
        if (channel.x_sampling != 1 || channel.y_sampling != 1)
            fail(file, "channel " + in_quotes(channel.name) + " must have a value for every pixel");
        bytes_per_pixel += channel.pixel_type == TINYEXR_PIXELTYPE_HALF ? 2 : 4;
    }
    if (static_cast<uint64_t>(width * height) * bytes_per_pixel > max_deflate_ratio * file_size) fail_truncated(file);
    check_memory(file, static_cast<uint64_t>(width * height) * 3 * sizeof(float), file_size);
    const EXRBox2i& display = header.display_window;
    const int64_t display_width = width_of(display), display_height = height_of(display);
    check_image_size(file, display_width, display_height);
    // What its data window does not explain.
    if (display_width * display_height > width * height)
        check_memory(file,
                     static_cast<uint64_t>(display_width * display_height * std::max(3, header.num_channels)) * sizeof(float),
                     file_size);
}

// Copies the decoded planes of the data window to the display window.
ExrFile collect(const std::filesystem::path& file, const EXRHeader& header, const EXRImage& decoded) {
    const EXRBox2i &data = header.data_window, &display = header.display_window;
    ExrFile exr;
    exr.image.width = static_cast<uint32_t>(width_of(display));
    exr.image.height = static_cast<uint32_t>(height_of(display));
    exr.is_complete =
        data.min_x <= display.min_x && data.max_x >= display.max_x && data.min_y <= display.min_y && data.max_y >= display.max_y;
    const size_t width = exr.image.width, pixel_count = width * exr.image.height;
    const int64_t begin_x = std::max(data.min_x, display.min_x), end_x = std::min(data.max_x, display.max_x) + int64_t{1};
    const auto copy = [&](const unsigned char* decoded_plane, float* target, size_t stride) {
        const auto* plane = reinterpret_cast<const float*>(decoded_plane);
        in_parallel(exr.image.height, 64, [&](size_t begin, size_t end) {
            for (size_t row = begin; row < end; ++row) {
                const int64_t y = static_cast<int64_t>(row) + display.min_y;
                if (y < data.min_y || y > data.max_y) continue;
                const float* source = plane + (y - data.min_y) * decoded.width;
                for (int64_t x = begin_x; x < end_x; ++x)
                    target[stride * (row * width + static_cast<size_t>(x - display.min_x))] = source[x - data.min_x];
            }
        });
    };
    exr.image.pixels.resize(3 * pixel_count);
    std::array<bool, 3> has_colour{};
    for (int i = 0; i < header.num_channels; ++i) {
        const size_t colour = colour_of(header.channels[i]);
        if (colour < 3) {
            has_colour[colour] = true;
            copy(decoded.images[i], exr.image.pixels.data() + colour, 3);
        } else if (header.pixel_types[i] != TINYEXR_PIXELTYPE_UINT) {
            std::vector<float>& channel = exr.channels[header.channels[i].name];
            channel.resize(pixel_count);
            copy(decoded.images[i], channel.data(), 1);
        }
    }
    if (std::ranges::count(has_colour, false) > 0) fail(file, "it needs the channels R, G and B");
    for (int i = 0; i < header.num_custom_attributes; ++i) {
        const EXRAttribute& attribute = header.custom_attributes[i];
        std::array<float, 8> chromaticities;
        if (std::string_view(attribute.type) == "chromaticities" && attribute.size == sizeof chromaticities) {
            std::memcpy(chromaticities.data(), attribute.value, sizeof chromaticities);
            exr.has_other_primaries = !are_primaries_of_srgb(chromaticities);
        }
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
        std::replace(header.requested_pixel_types, header.requested_pixel_types + header.num_channels, TINYEXR_PIXELTYPE_HALF,
                     TINYEXR_PIXELTYPE_FLOAT);
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
