"""OpenEXR files of one part: 32-bit float channels, compressed with ZIP a block of 16 rows, and string attributes."""
import os
import struct
import zlib

import numpy as np

MAGIC = b"\x76\x2f\x31\x01\x02\x00\x00\x00"  # and version 2: scan lines
ROWS_PER_BLOCK = 16
FLOAT, ZIP = 2, 3


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def compress(rows):
    """As OpenEXR prescribes: even bytes before odd ones, differences of neighbours, zlib; never longer than before."""
    content = np.frombuffer(rows, np.uint8)
    split = np.concatenate([content[0::2], content[1::2]]).astype(int)
    split[1:] = (split[1:] - split[:-1] + 128) % 256
    packed = zlib.compress(split.astype(np.uint8).tobytes(), 9)
    return packed if len(packed) < len(rows) else rows


def write_exr(path, channels, attributes):
    """channels: name -> array [row, column]; attributes: name -> text. The file appears complete or not at all."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    pixels = np.stack([channels[name] for name in names], axis=1).astype("<f4")  # [row, channel, column]
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = MAGIC
    header += attribute("channels", "chlist", b"".join(
        name.encode() + b"\0" + struct.pack("<iiii", FLOAT, 0, 1, 1) for name in names) + b"\0")
    header += attribute("compression", "compression", bytes([ZIP]))
    header += attribute("dataWindow", "box2i", window) + attribute("displayWindow", "box2i", window)
    header += attribute("lineOrder", "lineOrder", b"\0")
    header += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += attribute("screenWindowCenter", "v2f", struct.pack("<ff", 0, 0))
    header += attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    header += b"".join(attribute(name, "string", str(text).encode()) for name, text in attributes.items()) + b"\0"

    blocks, offsets = [], []
    position = len(header) + 8 * -(-height // ROWS_PER_BLOCK)
    for first in range(0, height, ROWS_PER_BLOCK):
        packed = compress(pixels[first:first + ROWS_PER_BLOCK].tobytes())
        offsets.append(position)
        blocks.append(struct.pack("<ii", first, len(packed)) + packed)
        position += len(blocks[-1])

    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(path.name + ".unfinished")
    unfinished.write_bytes(header + struct.pack(f"<{len(offsets)}Q", *offsets) + b"".join(blocks))
    os.replace(unfinished, path)


def read_attributes(path):
    """The string attributes of an OpenEXR file; those before the damage in a damaged one."""
    content = path.read_bytes()
    position, attributes = len(MAGIC), {}
    while content[position:position + 1] not in (b"", b"\0"):
        name, kind, rest = content[position:position + 1024].split(b"\0", 2)
        size = int.from_bytes(rest[:4], "little")
        position += len(name) + len(kind) + 6 + size
        if kind == b"string":
            attributes[name.decode()] = content[position - size:position].decode(errors="replace")
    return attributes
