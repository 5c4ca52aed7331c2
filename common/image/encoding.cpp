#include "image/encoding.h"

#include <zlib.h>

#include <new>

#include "parallel.h"

namespace lab {
namespace {

constexpr int level = 4;  // a higher level hardly shrinks noise further

// Compresses a part of a stream, without header and checksum.
std::string deflate_part(std::string_view bytes, int flush) {
    z_stream stream{};
    if (deflateInit2(&stream, level, Z_DEFLATED, -MAX_WBITS, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
    std::string result(deflateBound(&stream, static_cast<uLong>(bytes.size())) + 16,
                       '\0');  // 16: more than a flush adds
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(result.data());
    stream.avail_out = static_cast<uInt>(result.size());
    deflate(&stream, flush);
    result.resize(stream.total_out);
    deflateEnd(&stream);
    return result;
}

const Bytef* to_bytes(std::string_view bytes) { return reinterpret_cast<const Bytef*>(bytes.data()); }

std::string big_endian(uint32_t number) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(number >> shift & 255);
    return bytes;
}

}  // namespace

std::string compress_in_parallel(std::string_view bytes) {
    constexpr size_t piece_size = 1 << 18;
    struct Piece {
        std::string compressed;
        uLong checksum;
    };
    std::vector<Piece> pieces((bytes.size() + piece_size - 1) / piece_size);
    in_parallel(bytes.size(), piece_size, [&](size_t begin, size_t end) {
        const std::string_view piece = bytes.substr(begin, end - begin);
        const int flush = end == bytes.size() ? Z_FINISH : Z_SYNC_FLUSH;
        pieces[begin / piece_size] = {deflate_part(piece, flush),
                                      adler32(adler32(0, nullptr, 0), to_bytes(piece), static_cast<uInt>(piece.size()))};
    });
    std::string stream = "\x78\x5e";  // header: deflate with a 32 KiB window, fast level
    uLong checksum = adler32(0, nullptr, 0);
    for (size_t i = 0; i < pieces.size(); ++i) {
        const size_t size = std::min(piece_size, bytes.size() - i * piece_size);
        stream += pieces[i].compressed;
        checksum = adler32_combine(checksum, pieces[i].checksum, static_cast<z_off_t>(size));
    }
    return stream + big_endian(static_cast<uint32_t>(checksum));
}

}  // namespace lab
