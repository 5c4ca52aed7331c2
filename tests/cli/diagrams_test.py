"""The pages' diagrams, hand-drawn SVG files: legible on white and on black."""

import re
import unittest
import xml.etree.ElementTree as ElementTree

from program import PROJECT

DIAGRAMS = sorted((PROJECT / "docs/diagrams").glob("*.svg"))
SVG = "{http://www.w3.org/2000/svg}"
BACKGROUNDS = ("#ffffff", "#0d1117")
LEAST_CONTRAST = 3
CHARACTER_WIDTH = 0.6  # of a wide font, on average, in font sizes


def luminance(colour):
    """Relative luminance of #rrggbb (Web Content Accessibility Guidelines 2.1)."""
    channels = [int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    dark, light = sorted((luminance(a), luminance(b)))
    return (light + 0.05) / (dark + 0.05)


def text_width(text):
    """Approximate width of a <text> in pixels."""
    size = float(text.get("font-size"))
    spans = sum(len(span.text) * float(span.get("font-size", size)) + len(span.tail or "") * size for span in text)
    return CHARACTER_WIDTH * (len(text.text or "") * size + spans)


class DiagramsTest(unittest.TestCase):
    def roots(self):
        """(name, root element, width, height) of each diagram."""
        self.assertEqual(len(DIAGRAMS), 14)
        for path in DIAGRAMS:
            root = ElementTree.parse(path).getroot()
            left, top, width, height = map(float, root.get("viewBox").split())
            self.assertEqual((left, top, width), (0, 0, 640), path.name)
            yield path.stem, root, width, height

    def test_say_what_they_show(self):
        for name, root, _, _ in self.roots():
            self.assertGreater(len(root.findtext(f"{SVG}title")), 3, name)
            self.assertGreater(len(root.findtext(f"{SVG}desc")), 20, name)
            self.assertTrue(root.findall(f"{SVG}text"), name)

    def test_colours_are_seen_on_white_and_on_black(self):
        for name, root, _, _ in self.roots():
            colours = {element.get(key) for element in root.iter() for key in ("fill", "stroke")} - {None, "none"}
            for colour in colours:
                for background in BACKGROUNDS:
                    self.assertGreaterEqual(contrast(colour, background), LEAST_CONTRAST, f"{name}: {colour} on {background}")
            for text in root.iter(f"{SVG}text"):
                self.assertIn(text.get("fill"), colours, name)  # otherwise it is black

    def test_nothing_is_outside(self):
        for name, root, width, height in self.roots():
            for text in root.iter(f"{SVG}text"):
                words, length = "".join(text.itertext()), text_width(text)
                left = float(text.get("x")) - {"start": 0, "middle": 0.5, "end": 1}[text.get("text-anchor")] * length
                y, size = float(text.get("y")), float(text.get("font-size"))
                self.assertTrue(0 <= left and left + length <= width, f"{name}: '{words}' from {left:.0f} to {left + length:.0f}")
                self.assertTrue(size <= y + 0.25 * size and y + 0.25 * size <= height, f"{name}: '{words}' at the height {y:.0f}")
            for line in root.iter(f"{SVG}path"):
                for x, y in re.findall(r"([-\d.]+) ([-\d.]+)", line.get("d")):
                    self.assertTrue(0 <= float(x) <= width and 0 <= float(y) <= height, f"{name}: a line to {x}, {y}")
