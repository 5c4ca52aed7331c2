"""Image files as bytes, the same on every machine; pixel(x, y) with y down from the top row."""
import math
import struct
import zlib


def encode_png(width, height, pixel):
    """Eight bits a channel; a pixel is its sRGB-encoded red, green and blue in [0,1]."""
    rows = [b"\0" + bytes(round(255 * c) for x in range(width) for c in pixel(x, y)) for y in range(height)]

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    # Stored, a block a row: what zlib compresses to depends on its version, and git compresses anyway.
    blocks = b"".join(bytes([y == height - 1]) + struct.pack("<HH", len(row), 0xFFFF - len(row)) + row
                      for y, row in enumerate(rows))
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)  # 8 bits, RGB, not interlaced
    stream = b"\x78\x01" + blocks + struct.pack(">I", zlib.adler32(b"".join(rows)))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", stream) + chunk(b"IEND", b"")


def encode_hdr(width, height, pixel):
    """Radiance's RGBE format, at least 8 pixels wide; a pixel is its linear red, green and blue, none negative."""
    content = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    for y in range(height):
        pixels = []
        for x in range(width):
            rgb = pixel(x, y)
            exponent = math.frexp(max(rgb))[1]
            pixels.append([min(255, round(c * 2**(8 - exponent))) for c in rgb] + [exponent + 128])
        content += struct.pack(">BBH", 2, 2, width)  # a row: four planes, each in runs of at most 128 bytes
        for plane in zip(*pixels):
            for run in (plane[k:k + 128] for k in range(0, width, 128)):
                content += bytes([len(run), *run])
    return content
