"""Our image readers against what the formats say and what Pillow reads, for generated files of every construct."""

import re
from io import BytesIO

from program import BINARIES, ProgramTest  # first: it finds the others
import image_constructs
import numpy as np
from PIL import Image

# Where Pillow differs from the formats or from us: colours beyond a palette, which no format defines, are grey there; it does not
# cut 16-bit grey to 8 bits, and does not know palettes of 15 bits.
UNLIKE_PILLOW = re.compile("beyond_|png_0_16_|palette_15_")


def pillow_pixels(contents):
    """Red, green and blue that Pillow reads, or nothing."""
    try:
        with Image.open(BytesIO(contents)) as image:
            return np.array(image.convert("RGBA").convert("RGB"))
    except (OSError, ValueError, SyntaxError):
        return None


class ForeignImages_all(ProgramTest):
    def compare(self, files, tolerance, kind=np.uint8, channels=4):
        files = list(files)
        paths = [self.write(name, contents) for name, contents, _ in files]
        code, out, err = self.run_program(*paths, program=BINARIES / "read_images")
        self.assertEqual((code, out, err), (0, "", ""))
        for path, (name, _, expected) in zip(paths, files):
            with self.subTest(name):
                contents = path.with_name(name + ".pixels").read_bytes()
                width, height = np.frombuffer(contents, np.uint32, 2)
                pixels = np.frombuffer(contents, kind, offset=8).reshape(height, width, channels)[:, :, :3]
                self.assertEqual(pixels.shape, expected.shape)
                self.assertLessEqual(np.abs(pixels.astype(float) - expected).max(), tolerance)
        return files

    def check_expectation(self, files, tolerance):
        """Pillow reads the same as our own generator expects."""
        compared = 0
        for name, contents, expected in files:
            pixels = None if UNLIKE_PILLOW.search(name) else pillow_pixels(contents)
            if pixels is not None:
                compared += 1
                with self.subTest(f"{name}, Pillow"):
                    self.assertLessEqual(np.abs(pixels.astype(float) - expected).max(), tolerance)
        self.assertGreater(compared, 60)

    def test_png(self):
        self.check_expectation(self.compare(image_constructs.png_files(), 0), 0)

    def test_bmp(self):
        self.check_expectation(self.compare(image_constructs.bmp_files(), 1), 1)

    def test_tga(self):
        self.check_expectation(self.compare(image_constructs.tga_files(), 0), 0)

    def test_jpg(self):
        self.compare(image_constructs.jpg_files(), 6)

    def test_hdr(self):
        self.compare(image_constructs.hdr_files(), 0, np.float32, 3)
