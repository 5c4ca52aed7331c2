"""The chapters' pictures, read for comparison in tests."""

import tools_path  # noqa: F401  (first: it finds the others)
import numpy as np
from PIL import Image
from references import exr


class Exr(exr.Exr):
    """An OpenEXR file. Our reader is independent of the library that wrote it."""

    def __init__(self, path):
        super().__init__(path)
        self.height, self.width = self.channels["R"].shape
        self.channels = {name: channel.ravel().tolist() for name, channel in self.channels.items()}

    def text(self, name):
        """A string attribute."""
        return self.attributes[name]

    def pixels(self):
        """All values of R, then of G, then of B."""
        return self.channels["R"] + self.channels["G"] + self.channels["B"]

    def mean(self):
        """Mean of each of R, G and B."""
        return [sum(self.channels[name]) / (self.width * self.height) for name in "RGB"]


def read_png(path):
    """Width, height and pixels of a picture, as one list of tuples (r, g, b)."""
    with Image.open(path) as image:
        return *image.size, list(image.getdata())


def largest_ulp_difference(first, second):
    """The largest difference between two lists of floats, counted in ulps."""
    bits = [np.array(floats, np.float32).view(np.int32).astype(np.int64) for floats in (first, second)]
    ordered = [np.where(n >= 0, n, -(n & 0x7FFFFFFF)) for n in bits]
    return int(np.abs(ordered[0] - ordered[1]).max())


def relative_mse(image, reference):
    """The design's rel_mse, without correcting for the reference's own variance."""
    x, r = (np.array(file.pixels()) for file in (image, reference))
    return float(((x - r) ** 2 / (r**2 + 0.01 * r.mean() ** 2)).mean())
