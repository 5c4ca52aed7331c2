"""Valid image files of every construct that our readers accept, each with the pixels that its format gives it."""

import itertools
import struct
import zlib
from io import BytesIO

import numpy as np
from PIL import Image

RANDOM = np.random.default_rng(1)


def picture(width, height, channels=3):
    return RANDOM.integers(0, 256, (height, width, channels), np.uint8)


# ---------------------------------------------------------------------------------------------- bits
def packed(values, bits):
    """Rows of numbers of 1, 2, 4, 8 or 16 bits (big-endian) as rows of bytes."""
    if bits == 16:
        return [row.astype(">u2").tobytes() for row in values]
    return [np.packbits(np.unpackbits(row.astype(np.uint8)[:, None], axis=1)[:, 8 - bits :].ravel()).tobytes() for row in values]


def padded(row, multiple):
    return row + bytes(-len(row) % multiple)


def grey(values, largest):
    """Equal red, green and blue of whole numbers up to `largest`."""
    return np.repeat((values.astype(int) * 255 // largest).astype(np.uint8)[:, :, None], 3, axis=2)


def palettes(largest_size):
    """Palettes with numbers of colours, and numbers of indices in use: some lie beyond the end of a palette."""
    fewer = largest_size * 3 // 4
    for name, size, indices in (("whole", largest_size, largest_size), ("fewer", fewer, fewer), ("beyond", fewer, largest_size)):
        yield name, picture(size, 1)[0], indices


def through_palette(indices, palette):
    """The colours of indices; black beyond the palette."""
    return np.vstack([palette, np.zeros((65536 - len(palette), 3), np.uint8)])[indices]


# ---------------------------------------------------------------------------------------------- PNG
PNG_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}  # by colour type
ADAM7 = [(0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2)]  # x, y, steps


def chunk(kind, contents):
    return struct.pack(">I", len(contents)) + kind + contents + struct.pack(">I", zlib.crc32(kind + contents))


def paeth(left, above, both):
    guess = left + above - both
    distances = [abs(guess - neighbour) for neighbour in (left, above, both)]
    return (left, above, both)[distances.index(min(distances))]


def filtered(rows, pixel_size):
    """Rows of a PNG, each with another of the five filters."""
    before, result = bytes(len(rows[0])) if rows else b"", b""
    for number, row in enumerate(rows):
        kind = number % 5
        result += bytes([kind])
        for i, value in enumerate(row):
            left = row[i - pixel_size] if i >= pixel_size else 0
            both = before[i - pixel_size] if i >= pixel_size else 0
            guess = (0, left, before[i], (left + before[i]) // 2, paeth(left, before[i], both))[kind]
            result += bytes([(value - guess) & 255])
        before = row
    return result


def png(values, kind, bits, interlaced, further=b"", pieces=1):
    """values: [row, column, channel]."""
    height, width, channels = values.shape
    parts = [values[y::down, x::right] for x, y, right, down in ADAM7] if interlaced else [values]
    rows = b"".join(
        filtered(packed(part.reshape(part.shape[0], -1), bits), max(1, channels * bits // 8)) for part in parts if part.size
    )
    stream = zlib.compress(rows)
    cuts = [len(stream) * i // pieces for i in range(pieces + 1)]
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, interlaced))
        + chunk(b"tEXt", b"Title\0x")
        + further
        + b"".join(chunk(b"IDAT", stream[a:b]) for a, b in itertools.pairwise(cuts))
        + chunk(b"IEND", b"")
    )


def png_files():
    depths = {0: (1, 2, 4, 8, 16), 2: (8, 16), 3: (1, 2, 4, 8), 4: (8, 16), 6: (8, 16)}
    for kind, interlaced in itertools.product(depths, (0, 1)):
        for bits, (width, height) in itertools.product(depths[kind], ((1, 1), (3, 9), (17, 13))):
            name = f"png_{kind}_{bits}_{interlaced}_{width}.png"
            if kind == 3:
                for ending, palette, largest in palettes(1 << bits):
                    values = RANDOM.integers(0, largest, (height, width, 1), np.uint16)
                    further = chunk(b"PLTE", palette.tobytes()) + chunk(b"tRNS", b"\x80")
                    yield f"{ending}_{name}", png(values, kind, bits, interlaced, further), through_palette(
                        values[:, :, 0], palette
                    )
            else:
                values = RANDOM.integers(0, 1 << bits, (height, width, PNG_CHANNELS[kind]), np.uint16)
                numbers = values >> 8 if bits == 16 else values
                colours = numbers[:, :, :3].astype(np.uint8) if kind & 2 else grey(numbers[:, :, 0], (1 << min(bits, 8)) - 1)
                transparent = chunk(b"tRNS", bytes(2 * PNG_CHANNELS[kind])) if kind in (0, 2) else b""
                yield name, png(values, kind, bits, interlaced, transparent, pieces=3), colours


# ---------------------------------------------------------------------------------------------- BMP
def bmp(header, table, rows, gap=b""):
    start = 14 + 4 + len(header) + len(table) + len(gap)
    return b"BM" + struct.pack("<IHHII", start + len(rows), 0, 0, start, 4 + len(header)) + header + table + gap + rows


def bmp_header(size, width, height, bits, compression=0, colours=0, masks=(0, 0, 0, 0)):
    """The contents of a header behind its size."""
    if size == 12:
        return struct.pack("<HHHH", width, height, 1, bits)
    text = struct.pack("<iiHHIIiiII", width, height, 1, bits, compression, 0, 0, 0, colours, 0) + struct.pack("<4I", *masks)
    return (text + bytes(124))[: size - 4]


def bmp_rows(rows, height):
    return b"".join(padded(row, 4) for row in (rows if height < 0 else rows[::-1]))


def bmp_files():
    for size, bits, width, sign in itertools.product((12, 16, 40, 64, 108, 124), (1, 4, 8), (1, 5, 19), (1, -1)):
        if sign < 0 and size == 12:
            continue
        for name, palette, largest in palettes(1 << bits):
            if size < 40 and name != "whole":  # without a number of colours
                continue
            values = RANDOM.integers(0, largest, (7, width), np.uint8)
            table = b"".join(bytes(colour[::-1]) + b"\0" * (size != 12) for colour in palette)
            header = bmp_header(size, width, 7 * sign, bits, 0, len(palette) % (1 << bits))
            file = bmp(header, table, bmp_rows(packed(values, bits), sign), b"gap!")
            yield f"{name}_bmp_{size}_{bits}_{width}_{sign}.bmp", file, through_palette(values, palette)
    for size, width, sign in itertools.product((12, 16, 40, 64, 108, 124), (1, 2, 3, 4), (1, -1)):
        if sign < 0 and size == 12:
            continue
        colours = picture(width, 3)
        rows = bmp_rows([row[:, ::-1].tobytes() for row in colours], sign)
        yield f"bmp_24_{size}_{width}_{sign}.bmp", bmp(bmp_header(size, width, 3 * sign, 24), b"", rows), colours
    masks = {
        (16, "555"): (0x7C00, 0x3E0, 0x1F, 0),
        (16, "565"): (0xF800, 0x7E0, 0x1F, 0),
        (16, "4444"): (0xF00, 0xF0, 0xF, 0xF000),
        (16, "1555"): (0x7C00, 0x3E0, 0x1F, 0x8000),
        (32, "xrgb"): (0xFF0000, 0xFF00, 0xFF, 0),
        (32, "rgba"): (0xFF, 0xFF00, 0xFF0000, 0xFF000000),
        (32, "rgbx"): (0xFF000000, 0xFF0000, 0xFF00, 0),
        (32, "argb"): (0xFF0000, 0xFF00, 0xFF, 0xFF000000),
        (32, "small"): (0x7F00000, 0x1F000, 0x3, 0),
    }
    for size, (bits, name) in itertools.product((40, 52, 56, 108, 124), masks):
        four = masks[bits, name]
        if four[3] and size < 56:
            continue
        values = RANDOM.integers(0, 1 << bits, (3, 5), np.uint32)
        rows = bmp_rows([row.astype("<u2" if bits == 16 else "<u4").tobytes() for row in values], 1)
        table = struct.pack("<3I", *four[:3]) if size == 40 else b""
        channels = [((values & mask) // (mask & -mask), mask // (mask & -mask)) for mask in four[:3]]
        colours = np.stack(
            [(part.astype(np.int64) * 255 + largest // 2) // largest for part, largest in channels], axis=2
        ).astype(np.uint8)
        yield f"bmp_masks_{name}_{size}.bmp", bmp(bmp_header(size, 5, 3, bits, 3, 0, four), table, rows), colours
        if name in ("555", "xrgb"):  # the masks that hold if none are given
            yield f"bmp_plain_{name}_{size}.bmp", bmp(bmp_header(size, 5, 3, bits), b"", rows), colours


# ---------------------------------------------------------------------------------------------- TGA
def run_lengths(pixels):
    """Pixels, as a list of bytes, in packets: runs, and up to 5 pixels as they are. Packets cross rows."""
    result, i = b"", 0
    while i < len(pixels):
        run = 1
        while run < 128 and i + run < len(pixels) and pixels[i + run] == pixels[i]:
            run += 1
        if run > 1:
            result += bytes([127 + run]) + pixels[i]
            i += run
        else:
            count = min(5, len(pixels) - i)
            result += bytes([count - 1]) + b"".join(pixels[i : i + count])
            i += count
    return result


def tga(kind, values, pixel, bits, descriptor, palette=b"", start=0, length=0, palette_bits=0):
    """values: [row, column] or [row, column, channel], of which `pixel` gives the bytes."""
    height, width = values.shape[:2]
    placed = values if descriptor & 0x20 else values[::-1]
    placed = placed[:, ::-1] if descriptor & 0x10 else placed
    pixels = [pixel(value) for row in placed for value in row]
    contents = run_lengths(pixels) if kind & 8 else b"".join(pixels)
    return (
        struct.pack("<BBBHHBHHHHBB", 3, bool(length), kind, start, length, palette_bits, 0, 0, width, height, bits, descriptor)
        + b"id!"
        + palette
        + contents
    )


def tga_files():
    def number(size):
        return lambda value: int(value).to_bytes(size, "little")

    for packets, corner in itertools.product((0, 8), (0, 0x10, 0x20, 0x30)):
        values = picture(9, 6) // 128 * 200
        name = f"tga_{packets}_{corner}"
        yield f"{name}_24.tga", tga(2 | packets, values, lambda v: bytes(v[::-1]), 24, corner), values
        for alpha in (0, 8):
            file = tga(2 | packets, values, lambda v: bytes(v[::-1]) + b"\x55", 32, corner | alpha)
            yield f"{name}_32_{alpha}.tga", file, values
        fifths = RANDOM.integers(0, 32, (6, 9, 3), np.uint16)
        yield (
            f"{name}_16.tga",
            tga(2 | packets, fifths, lambda v: number(2)(v[0] << 10 | v[1] << 5 | v[2]), 16, corner),
            (fifths * 255 // 31).astype(np.uint8),
        )
        yield f"{name}_grey.tga", tga(3 | packets, values[:, :, 0], number(1), 8, corner), grey(values[:, :, 0], 255)
        yield (
            f"{name}_grey_alpha.tga",
            tga(3 | packets, values[:, :, 0], lambda v: bytes([v, 99]), 16, corner | 8),
            grey(values[:, :, 0], 255),
        )
        kinds = itertools.product((15, 16, 24, 32), (0, 5), (1, 2), palettes(40))
        for palette_bits, start, index_size, (ending, colours, largest) in kinds:
            indices = RANDOM.integers(start, start + largest, (6, 9))
            if palette_bits < 24:
                numbers = colours.astype(int) >> 3
                table = b"".join(number(2)(r << 10 | g << 5 | b) for r, g, b in numbers)
                colours = (numbers * 255 // 31).astype(np.uint8)
            else:
                table = b"".join(bytes(colour[::-1]) + b"\xff" * (palette_bits == 32) for colour in colours)
            expected = through_palette(indices, np.vstack([np.zeros((start, 3), np.uint8), colours]))
            file = tga(1 | packets, indices, number(index_size), 8 * index_size, corner, table, start, len(colours), palette_bits)
            yield f"{ending}_{name}_palette_{palette_bits}_{start}_{index_size}.tga", file, expected
    values = picture(4, 3)
    yield "tga_unused_palette.tga", tga(2, values, lambda v: bytes(v[::-1]), 24, 0, bytes(30), 0, 10, 24), values


# ---------------------------------------------------------------------------------------------- JPEG
def jpg_files():
    """What Pillow writes, with what it reads again."""
    smooth = np.add.outer(np.arange(37) * 3, np.arange(29) * 2)[:, :, None] + np.array([0, 40, 80])
    noise = picture(29, 37)
    pictures = {"smooth": smooth.astype(np.uint8), "noise": noise // 2, "pixel": noise[:1, :1]}
    kinds = itertools.product(pictures.items(), ("RGB", "L", "CMYK"), (0, 1, 2), (False, True))
    for (name, values), mode, subsampling, progressive in kinds:
        if name == "noise" and subsampling > 0:  # stb_image interpolates the colours at the right border otherwise
            continue
        stream = BytesIO()
        Image.fromarray(values).convert(mode).save(
            stream, "JPEG", quality=90, subsampling=subsampling, progressive=progressive, optimize=progressive
        )
        file = stream.getvalue()
        yield f"jpg_{name}_{mode}_{subsampling}_{progressive}.jpg", file, np.array(Image.open(BytesIO(file)).convert("RGB"))


# ---------------------------------------------------------------------------------------------- HDR
def hdr_rows(rgbe, runs):
    """Pixels [row, column, 4] as they are, with old run lengths, or with those of today."""
    result = b""
    for row in rgbe:
        if runs == "new":
            result += struct.pack(">BBH", 2, 2, len(row))
            for channel in row.T:
                for value, group in itertools.groupby(channel.tolist()):
                    count = len(list(group))
                    result += bytes([255, value]) * (count // 127) + (
                        bytes([128 + count % 127, value]) if count % 127 > 1 else bytes([1, value]) * (count % 127)
                    )
        else:
            for pixel, group in itertools.groupby(row.tolist()):
                repeats = len(list(group)) - 1
                result += bytes(pixel)
                if runs == "old":
                    while repeats:
                        result += bytes([1, 1, 1, repeats & 255])
                        repeats >>= 8
                else:
                    result += bytes(pixel) * repeats
    return result


def hdr_files():
    headers = {
        "plain": ("", 1),
        "exposure": ("EXPOSURE=4\nEXPOSURE=0.5\n", 2),
        "colour": ("COLORCORR=1 2 4\n", np.array([1, 2, 4])),
        "windows": ("EXPOSURE= 2\n# a comment\nVIEW=-vtv\n", 2),
    }
    for (name, (header, factor)), runs, width in itertools.product(headers.items(), ("none", "old", "new"), (1, 7, 8, 120)):
        if runs == "new" and width < 8:
            continue
        rgbe = np.repeat(RANDOM.integers(2, 256, (3, width, 4), np.uint8), 1 + (width > 8) * (1 if runs == "new" else 5), axis=1)
        rgbe[:, :, 3] = RANDOM.integers(100, 150, (3, 1))
        rgbe[0, 0] = 0
        height, width = rgbe.shape[:2]
        text = f"#?RADIANCE\n{header}FORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n"
        if name == "windows":
            text = text.replace("\n", "\r\n")
        values = np.where(rgbe[:, :, 3:] == 0, 0, rgbe[:, :, :3] * 2.0 ** (rgbe[:, :, 3:].astype(int) - 136)) / factor
        yield f"hdr_{name}_{runs}_{width}.hdr", text.encode() + hdr_rows(rgbe, runs), values.astype(np.float32)
