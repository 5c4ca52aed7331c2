"""Reads the pictures that the chapters write, independently of the libraries that wrote them."""

import itertools
import struct
import zlib
from array import array


class Exr:
    """A scan line OpenEXR file with 32-bit float channels, uncompressed or ZIP-compressed."""

    def __init__(self, path):
        with open(path, "rb") as stream:
            data = stream.read()
        magic, version = struct.unpack_from("<II", data)
        if magic != 20000630 or version & 0xFF != 2:
            raise ValueError(f"{path} is no OpenEXR file")
        self.attributes = {}  # name -> raw bytes
        position = 8
        while data[position] != 0:
            name, position = _text(data, position)
            _, position = _text(data, position)
            (size,) = struct.unpack_from("<i", data, position)
            self.attributes[name] = data[position + 4 : position + 4 + size]
            position += 4 + size
        position += 1

        left, top, right, bottom = struct.unpack("<4i", self.attributes["dataWindow"])
        self.width, self.height = right - left + 1, bottom - top + 1
        self.names = self._channel_names()
        self.channels = {name: array("f") for name in self.names}
        lines_per_block = {0: 1, 2: 1, 3: 16}[self.attributes["compression"][0]]
        block_count = -(-self.height // lines_per_block)
        offsets = struct.unpack_from(f"<{block_count}Q", data, position)
        for index, offset in enumerate(offsets):
            lines = min(lines_per_block, self.height - index * lines_per_block)
            (size,) = struct.unpack_from("<i", data, offset + 4)
            raw_size = 4 * lines * self.width * len(self.names)
            block = data[offset + 8 : offset + 8 + size]
            if size != raw_size:
                block = _unpredict(zlib.decompress(block))
            floats = array("f", block)
            for line in range(lines):
                for number, name in enumerate(self.names):
                    start = (line * len(self.names) + number) * self.width
                    self.channels[name].extend(floats[start : start + self.width])

    def _channel_names(self):
        data, position, names = self.attributes["channels"], 0, []
        while data[position] != 0:
            name, position = _text(data, position)
            (pixel_type,) = struct.unpack_from("<i", data, position)
            if pixel_type != 2:
                raise ValueError(f"channel {name} is not of 32-bit floats")
            position += 16
            names.append(name)
        return names

    def text(self, name):
        """A string attribute."""
        return self.attributes[name].decode()

    def pixels(self):
        """All numbers of R, then of G, then of B."""
        return self.channels["R"] + self.channels["G"] + self.channels["B"]

    def mean(self):
        """Mean of each of R, G and B."""
        return [sum(self.channels[name]) / (self.width * self.height) for name in "RGB"]


def _text(data, position):
    end = data.index(0, position)
    return data[position:end].decode(), end + 1


def _unpredict(data):
    """Undoes OpenEXR's byte differences and the separation of even and odd bytes."""
    sums = bytes((total - 128 * index) & 255 for index, total in enumerate(itertools.accumulate(data)))
    half = (len(sums) + 1) // 2
    result = bytearray(len(sums))
    result[0::2], result[1::2] = sums[:half], sums[half:]
    return bytes(result)


def read_png(path):
    """Width, height and the bytes of an 8-bit RGB or RGBA picture, as one list of tuples (r, g, b)."""
    with open(path, "rb") as stream:
        data = stream.read()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError(f"{path} is no PNG file")
    position, compressed = 8, b""
    while position < len(data):
        size, kind = struct.unpack_from(">I4s", data, position)
        chunk = data[position + 8 : position + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack_from(">IIBB", chunk)
        elif kind == b"IDAT":
            compressed += chunk
        position += 12 + size
    step = {2: 3, 6: 4}[colour]
    if depth != 8:
        raise ValueError(f"{path} has {depth} bits a channel")
    lines, previous = zlib.decompress(compressed), bytes(step * width)
    pixels = []
    for y in range(height):
        start = y * (step * width + 1)
        line = bytearray(lines[start + 1 : start + 1 + step * width])
        for i in range(len(line)):
            a, b = line[i - step] if i >= step else 0, previous[i]
            c = previous[i - step] if i >= step else 0
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[i] = (line[i] + (0, a, b, (a + b) // 2, paeth)[lines[start]]) & 255
        previous = line
        pixels += [tuple(line[i : i + 3]) for i in range(0, len(line), step)]
    return width, height, pixels


def largest_ulp_difference(first, second):
    """How many floats lie between the most different pair of two arrays of floats."""

    def ordered(floats):
        return [n if n >= 0 else -(n & 0x7FFFFFFF) for n in array("i", floats.tobytes())]

    if len(first) != len(second):
        raise ValueError("different sizes")
    return max(abs(a - b) for a, b in zip(ordered(first), ordered(second)))


def relative_mse(image, reference):
    """The design's rel_mse without a correction for the reference's own variance."""
    x, r = image.pixels(), reference.pixels()
    floor = 0.01 * (sum(r) / len(r)) ** 2
    return sum((a - b) ** 2 / (b * b + floor) for a, b in zip(x, r)) / len(r)
