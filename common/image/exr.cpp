// Reads and writes OpenEXR files, block by block on all threads, with the C interface of the format's authors: their C++ classes
// (3.1) take what a damaged block lacks from memory that nobody wrote.
#include <openexr.h>

#include <array>
#include <cstring>

#include "error.h"
#include "files/file.h"
#include "image/image.h"
#include "image/image_checks.h"
#include "parallel.h"

namespace lab {
namespace {

// Throws UserError unless OpenEXR succeeded.
void require(const std::filesystem::path& file, exr_result_t result) {
    if (result != EXR_ERR_SUCCESS)
        fail(file, std::string("damaged or unsupported OpenEXR file: ") + exr_get_default_error_message(result));
}

int64_t read_bytes(exr_const_context_t, void* file, void* target, uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t) {
    const auto& bytes = *static_cast<const std::string*>(file);
    if (offset >= bytes.size()) return 0;
    const size_t length = std::min<uint64_t>(size, bytes.size() - offset);
    std::memcpy(target, bytes.data() + offset, length);
    return static_cast<int64_t>(length);
}

int64_t size_in_bytes(exr_const_context_t, void* file) {
    return static_cast<int64_t>(static_cast<const std::string*>(file)->size());
}

int64_t write_bytes(exr_const_context_t, void* file, const void* source, uint64_t size, uint64_t offset,
                    exr_stream_error_func_ptr_t) {
    auto& bytes = *static_cast<std::string*>(file);
    bytes.resize(std::max<uint64_t>(bytes.size(), offset + size));
    std::memcpy(bytes.data() + offset, source, size);
    return static_cast<int64_t>(size);
}

// An OpenEXR file in memory.
class Context {
  public:
    explicit Context(std::string& bytes) {
        options_.user_data = &bytes;
        options_.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // the default one prints
    }
    ~Context() { exr_finish(&context_); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    exr_result_t start_read() {
        options_.read_fn = read_bytes;
        options_.size_fn = size_in_bytes;
        // A damaged header or table of blocks is refused, not guessed.
        options_.flags = EXR_CONTEXT_FLAG_STRICT_HEADER | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
        return exr_start_read(&context_, "picture", &options_);
    }
    exr_result_t start_write() {
        options_.write_fn = write_bytes;
        return exr_start_write(&context_, "picture", EXR_WRITE_FILE_DIRECTLY, &options_);
    }
    exr_result_t finish() { return exr_finish(&context_); }
    operator exr_context_t() const { return context_; }

  private:
    exr_context_initializer_t options_ = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t context_ = nullptr;
};

// Which of R, G and B a channel is, or npos.
size_t colour_of(std::string_view channel) {
    return channel.size() == 1 ? std::string_view("RGB").find(channel) : std::string_view::npos;
}

int64_t width_of(const exr_attr_box2i_t& window) { return int64_t{window.max.x} - window.min.x + 1; }
int64_t height_of(const exr_attr_box2i_t& window) { return int64_t{window.max.y} - window.min.y + 1; }

std::string name_of(size_t compression) {
    constexpr std::array names{"none", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"};
    return compression < names.size() ? names[compression] : "number " + std::to_string(compression);
}

struct Windows {
    exr_attr_box2i_t data, display;
};

// Checks that sizes are within the limits and the file, and that every channel covers the whole data window.
Windows check_header(const std::filesystem::path& file, exr_const_context_t context, uint64_t file_size) {
    int parts = 0;
    exr_storage_t storage{};
    require(file, exr_get_count(context, &parts));
    require(file, exr_get_storage(context, 0, &storage));
    if (parts != 1 || storage != EXR_STORAGE_SCANLINE)
        fail(file, "only flat OpenEXR images of scan lines in a single part are read");
    exr_compression_t compression{};
    require(file, exr_get_compression(context, 0, &compression));
    if (compression > EXR_COMPRESSION_PIZ)  // (3.1) does not read some of the others, and takes unknown ones for none
        fail(file, "its compression (" + name_of(compression) + ") is not read: export it with ZIP, PIZ, RLE or none");
    Windows windows{};
    const auto& [data, display] = windows;
    const exr_attr_chlist_t* channels = nullptr;
    require(file, exr_get_data_window(context, 0, &windows.data));
    require(file, exr_get_display_window(context, 0, &windows.display));
    require(file, exr_get_channels(context, 0, &channels));
    check_image_size(file, width_of(data), height_of(data));
    check_image_size(file, width_of(display), height_of(display));
    constexpr int max_channels = 64;
    if (channels->num_channels > max_channels) fail(file, "it has more than 64 channels");
    uint64_t bytes_per_pixel = 0;
    int colours = 0;
    for (const exr_attr_chlist_entry_t& channel : std::span(channels->entries, static_cast<size_t>(channels->num_channels))) {
        const bool is_colour = colour_of(channel.name.str) != std::string_view::npos;
        colours += is_colour;
        if (is_colour && channel.pixel_type == EXR_PIXEL_UINT)
            fail(file, "channel " + in_quotes(channel.name.str) + " must hold 16 or 32-bit floats");
        if (channel.x_sampling != 1 || channel.y_sampling != 1)
            fail(file, "channel " + in_quotes(channel.name.str) + " must have a value for every pixel");
        bytes_per_pixel += channel.pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    }
    if (colours != 3) fail(file, "it needs the channels R, G and B");
    if (static_cast<uint64_t>(width_of(data) * height_of(data)) * bytes_per_pixel > max_deflate_ratio * file_size)
        fail_truncated(file);
    check_memory(file, static_cast<uint64_t>(width_of(display) * height_of(display) * channels->num_channels) * sizeof(float),
                 file_size);
    return windows;
}

// A channel in memory: element i is first[i * stride].
template <typename Float>
struct Plane {
    Float* first;
    size_t stride;
};

// The floats of an image by name, sorted as in a file.
template <typename Float, typename Exr>
std::map<std::string, Plane<Float>> planes_of(Exr& exr) {
    std::map<std::string, Plane<Float>> planes;
    for (size_t colour = 0; colour < 3; ++colour) planes[std::string(1, "RGB"[colour])] = {exr.image.pixels.data() + colour, 3};
    for (auto& [name, numbers] : exr.channels) planes[name] = {numbers.data(), 1};
    return planes;
}

// Reads the rows of the block that starts at row y into the part of the image that lies in both windows.
void read_block(const std::filesystem::path& file, exr_const_context_t context, int y, const Windows& windows,
                const std::map<std::string, Plane<float>>& planes) {
    const auto& [data, display] = windows;
    exr_chunk_info_t block;
    require(file, exr_read_scanline_chunk_info(context, 0, y, &block));
    // (3.1) decodes what memory happens to contain.
    if (block.compression == EXR_COMPRESSION_NONE && block.packed_size != block.unpacked_size) fail_damaged(file);
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    require(file, exr_decoding_initialize(context, 0, &block, &decoder));
    const auto destroy = [&](exr_decode_pipeline_t* pipeline) { exr_decoding_destroy(context, pipeline); };
    const std::unique_ptr<exr_decode_pipeline_t, decltype(destroy)> destroys(&decoder, destroy);
    const std::span channels(decoder.channels, static_cast<size_t>(decoder.channel_count));
    const auto width = static_cast<size_t>(block.width), size = width * static_cast<size_t>(block.height);
    std::vector<float> rows(size * channels.size());  // channel after channel; (3.1) crashes if one has no place
    for (size_t i = 0; i < channels.size(); ++i) {
        channels[i].decode_to_ptr = reinterpret_cast<uint8_t*>(&rows[i * size]);
        if (channels[i].data_type == EXR_PIXEL_HALF) channels[i].user_data_type = EXR_PIXEL_FLOAT;
        channels[i].user_bytes_per_element = sizeof(float);
        channels[i].user_pixel_stride = sizeof(float);
        channels[i].user_line_stride = static_cast<int32_t>(width * sizeof(float));
    }
    require(file, exr_decoding_choose_default_routines(context, 0, &decoder));
    require(file, exr_decoding_run(context, 0, &decoder));
    const int begin_x = std::max(data.min.x, display.min.x), end_x = std::min(data.max.x, display.max.x) + 1;
    const int begin_y = std::max(y, display.min.y), end_y = std::min(y + block.height - 1, display.max.y) + 1;
    for (size_t i = 0; i < channels.size(); ++i) {
        const auto plane = planes.find(channels[i].channel_name);
        if (plane == planes.end()) continue;  // integers
        const auto& [first, stride] = plane->second;
        for (int row = begin_y; row < end_y; ++row)
            for (int x = begin_x; x < end_x; ++x)
                first[stride * static_cast<size_t>((row - display.min.y) * width_of(display) + x - display.min.x)] =
                    rows[i * size + static_cast<size_t>(row - y) * width + static_cast<size_t>(x - data.min.x)];
    }
}

}  // namespace

ExrFile read_exr(const std::filesystem::path& file) {
    std::string bytes = read_file(file, max_image_file_bytes);
    if (!bytes.starts_with("\x76\x2f\x31\x01")) fail(file, "not an OpenEXR file");
    // ./lab reference gives the renderer's version as a string, but OpenEXR wants a number under that name.
    const size_t version = bytes.find(std::string_view("version\0string\0", 15));
    if (version != std::string::npos) bytes[version] = 'V';
    Context context(bytes);
    require(file, context.start_read());
    const Windows windows = check_header(file, context, bytes.size());
    const auto& [data, display] = windows;
    const auto width = static_cast<size_t>(width_of(display)), height = static_cast<size_t>(height_of(display));

    ExrFile exr;
    exr.image = {static_cast<uint32_t>(width), static_cast<uint32_t>(height), std::vector<float>(3 * width * height)};
    exr.is_complete =
        data.min.x <= display.min.x && data.max.x >= display.max.x && data.min.y <= display.min.y && data.max.y >= display.max.y;
    int attributes = 0;
    require(file, exr_get_attribute_count(context, 0, &attributes));
    for (int i = 0; i < attributes; ++i) {
        const exr_attribute_t* attribute = nullptr;
        require(file, exr_get_attribute_by_index(context, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute));
        if (attribute->type == EXR_ATTR_STRING && std::string_view(attribute->name) != "type")
            exr.attributes[attribute->name] = std::string(attribute->string->str, static_cast<size_t>(attribute->string->length));
        if (attribute->type == EXR_ATTR_CHROMATICITIES) {
            std::array<float, 8> numbers;
            static_assert(sizeof numbers == sizeof *attribute->chromaticities);
            std::memcpy(numbers.data(), attribute->chromaticities, sizeof numbers);
            exr.has_other_primaries = !are_primaries_of_srgb(numbers);
        }
        if (attribute->type == EXR_ATTR_CHLIST)
            for (const exr_attr_chlist_entry_t& channel :
                 std::span(attribute->chlist->entries, static_cast<size_t>(attribute->chlist->num_channels)))
                if (channel.pixel_type != EXR_PIXEL_UINT && colour_of(channel.name.str) == std::string_view::npos)
                    exr.channels[channel.name.str].resize(width * height);
    }
    const auto planes = planes_of<float>(exr);
    int rows_per_block = 0;
    require(file, exr_get_scanlines_per_chunk(context, 0, &rows_per_block));
    in_parallel(static_cast<size_t>(height_of(data)), static_cast<size_t>(rows_per_block), [&](size_t begin, size_t end) {
        const int64_t first = data.min.y + static_cast<int64_t>(begin), last = data.min.y + static_cast<int64_t>(end) - 1;
        if (first <= display.max.y && last >= display.min.y) read_block(file, context, static_cast<int>(first), windows, planes);
    });
    return exr;
}

void write_exr(const std::filesystem::path& file, const ExrFile& exr) {
    std::string bytes;
    Context context(bytes);
    const auto planes = planes_of<const float>(exr);
    const auto width = static_cast<int32_t>(exr.image.width), height = static_cast<int32_t>(exr.image.height);
    int rows_per_block = 0;
    require(file, context.start_write());
    require(file, exr_add_part(context, nullptr, EXR_STORAGE_SCANLINE, nullptr));
    require(file, exr_initialize_required_attr_simple(context, 0, width, height, EXR_COMPRESSION_ZIP));
    require(file, exr_set_zip_compression_level(context, 0, 1));  // a higher level does not shrink noise
    for (const auto& [name, plane] : planes)
        require(file, exr_add_channel(context, 0, name.c_str(), EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    for (const auto& [name, text] : exr.attributes) require(file, exr_attr_set_string(context, 0, name.c_str(), text.c_str()));
    require(file, exr_write_header(context));
    require(file, exr_get_scanlines_per_chunk(context, 0, &rows_per_block));

    const auto piece = static_cast<size_t>(rows_per_block);
    std::vector<std::string> blocks((exr.image.height + piece - 1) / piece);
    in_parallel(exr.image.height, piece, [&](size_t begin, size_t) {
        exr_chunk_info_t block;
        require(file, exr_write_scanline_chunk_info(context, 0, static_cast<int>(begin), &block));
        exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
        require(file, exr_encoding_initialize(context, 0, &block, &encoder));
        for (exr_coding_channel_info_t& channel : std::span(encoder.channels, static_cast<size_t>(encoder.channel_count))) {
            const auto& [first, stride] = planes.at(channel.channel_name);
            channel.encode_from_ptr = reinterpret_cast<const uint8_t*>(first + begin * exr.image.width * stride);
            channel.user_pixel_stride = static_cast<int32_t>(stride * sizeof(float));
            channel.user_line_stride = channel.user_pixel_stride * width;
        }
        require(file, exr_encoding_choose_default_routines(context, 0, &encoder));
        encoder.yield_until_ready_fn = encoder.write_fn = nullptr;  // blocks are written below, in order
        require(file, exr_encoding_run(context, 0, &encoder));
        // A block of the full size is read as it is. (3.1) also writes a compressed one that happens to have that size.
        const bool is_smaller = encoder.compressed_bytes < encoder.packed_bytes;
        blocks[begin / piece].assign(static_cast<const char*>(is_smaller ? encoder.compressed_buffer : encoder.packed_buffer),
                                     encoder.compressed_bytes);
        require(file, exr_encoding_destroy(context, &encoder));
    });
    for (size_t i = 0; i < blocks.size(); ++i)
        require(file, exr_write_scanline_chunk(context, 0, static_cast<int>(i * piece), blocks[i].data(), blocks[i].size()));
    require(file, context.finish());
    write_file(file, bytes);
}

}  // namespace lab
