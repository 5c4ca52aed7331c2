"""Reads and writes OpenEXR files: one part, 32-bit float channels in scan lines, ZIP compression, string attributes.

Debian 12's only Python binding for OpenEXR is OpenImageIO's, which pulls in 80 packages; ./lab check also needs this on Windows.
"""
import re
import struct
import zlib

import numpy as np
from project import write_bytes

MAGIC = b"\x76\x2f\x31\x01\x02\x00\x00\x00"  # and version 2: scan lines
ROWS_PER_BLOCK = {0: 1, 2: 1, 3: 16}  # by compression: none, ZIP per row, ZIP
FLOAT, ZIP = 2, 3


class Exr:
    """Channels, name -> array [row, column], and string attributes, name -> text, of a file written here or by a chapter. Raises
    ValueError if it is damaged or of another kind."""

    def __init__(self, path):
        content = path.read_bytes()
        try:
            self.channels, self.attributes = read_channels(content), string_attributes(content)
        except (IndexError, KeyError, struct.error, zlib.error, ValueError) as error:
            raise ValueError(f"not an OpenEXR file of 32-bit float scan lines, or damaged: {error}") from None

    def rgb(self, prefix=""):
        """Array [row, column, channel] of channels R, G and B, or of those with a prefix; KeyError if there are none."""
        return np.stack([self.channels[prefix + name] for name in "RGB"], axis=2).astype(float)


# ---------------------------------------------------------------------------------------------- writing
def rgb_channels(image, prefix=""):
    """The channels of an array [row, column, channel]."""
    return {prefix + name: image[:, :, i] for i, name in enumerate("RGB")}


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def compress(rows):
    """OpenEXR's ZIP predictor: even bytes before odd ones, differences of neighbours, zlib; never longer than the input."""
    content = np.frombuffer(rows, np.uint8)
    split = np.concatenate([content[0::2], content[1::2]])
    split[1:] = split[1:] - split[:-1] + np.uint8(128)  # modulo 256
    packed = zlib.compress(split.tobytes(), 9)
    return packed if len(packed) < len(rows) else rows


def write_exr(path, channels, attributes):
    """channels: name -> array [row, column]; attributes: name -> text. The file appears complete or not at all."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    pixels = np.stack([channels[name] for name in names], axis=1).astype("<f4")  # [row, channel, column]
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = MAGIC
    header += attribute(
        "channels", "chlist", b"".join(name.encode() + b"\0" + struct.pack("<iiii", FLOAT, 0, 1, 1) for name in names) + b"\0"
    )
    header += attribute("compression", "compression", bytes([ZIP]))
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    header += b"".join(attribute(name, "string", str(text).encode()) for name, text in attributes.items()) + b"\0"

    step, blocks, offsets = ROWS_PER_BLOCK[ZIP], [], []
    position = len(header) + 8 * -(-height // step)
    for first in range(0, height, step):
        packed = compress(pixels[first : first + step].tobytes())
        offsets.append(position)
        blocks.append(struct.pack("<ii", first, len(packed)) + packed)
        position += len(blocks[-1])

    write_bytes(path, header + struct.pack(f"<{len(offsets)}Q", *offsets) + b"".join(blocks))


# ---------------------------------------------------------------------------------------------- reading
def read_header(content):
    """Attributes up to the damage, if any, as name -> (kind, bytes), and the position where the header ends."""
    position, attributes = len(MAGIC), {}
    while content[position : position + 1] not in (b"", b"\0"):
        name, kind, rest = content[position : position + 1024].split(b"\0", 2)
        size = int.from_bytes(rest[:4], "little")
        position += len(name) + len(kind) + 6 + size
        attributes[name.decode()] = kind, content[position - size : position]
    return attributes, position + 1


def string_attributes(content):
    return {name: value.decode(errors="replace") for name, (kind, value) in read_header(content)[0].items() if kind == b"string"}


def read_attributes(path):
    """The string attributes of an OpenEXR file; if it is damaged, those before the damage."""
    return string_attributes(path.read_bytes())


def read_channels(content):
    if content[:8] != MAGIC:
        raise ValueError("it starts otherwise")
    header, position = read_header(content)
    left, top, right, bottom = struct.unpack("<4i", header["dataWindow"][1])
    width, height = right - left + 1, bottom - top + 1
    names = []
    for entry in re.finditer(rb"([^\0]+)\0(.{16})", header["channels"][1], re.DOTALL):  # type and sampling
        names.append(entry[1].decode())
        if struct.unpack_from("<i", entry[2])[0] != FLOAT:
            raise ValueError(f"channel {names[-1]} is of another type")
    step, rows = ROWS_PER_BLOCK[header["compression"][1][0]], []
    for offset in struct.unpack_from(f"<{-(-height // step)}Q", content, position):
        first, size = struct.unpack_from("<ii", content, offset)
        block = content[offset + 8 : offset + 8 + size]
        shape = (min(step, height - (first - top)), len(names), width)
        rows.append(np.frombuffer(expand(block, 4 * np.prod(shape)), "<f4").reshape(shape))
    pixels = np.concatenate(rows)
    return {name: pixels[:, i, :] for i, name in enumerate(names)}


def expand(block, size):
    """The inverse of compress()."""
    if len(block) == size:
        return block
    split = np.frombuffer(zlib.decompress(block), np.uint8).copy()
    split[1:] -= np.uint8(128)
    split = np.cumsum(split, dtype=np.uint8)
    content = np.empty_like(split)
    content[0::2], content[1::2] = np.split(split, [(len(split) + 1) // 2])
    return content.tobytes()
