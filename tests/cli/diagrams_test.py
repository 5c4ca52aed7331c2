"""The pages' diagrams, hand-drawn SVG files."""

import unittest
import xml.etree.ElementTree as ElementTree

from program import PROJECT

DIAGRAMS = sorted((PROJECT / "docs/diagrams").glob("*.svg"))
SVG = "{http://www.w3.org/2000/svg}"


class DiagramsTest(unittest.TestCase):
    def test_say_what_they_show(self):
        self.assertTrue(DIAGRAMS)
        for path in DIAGRAMS:
            root = ElementTree.parse(path).getroot()
            self.assertGreater(len(root.findtext(f"{SVG}title")), 3, path.name)
            self.assertGreater(len(root.findtext(f"{SVG}desc")), 20, path.name)
            self.assertTrue(root.findall(f"{SVG}text"), path.name)

    def test_shader_binding_table_has_a_record_per_shader(self):
        records = [text.text for text in ElementTree.parse(PROJECT / "docs/diagrams/shader_binding_table.svg").iter(f"{SVG}text")]
        for label, suffix in (("ray generation", "rgen"), ("miss", "rmiss")):
            shaders = list((PROJECT / "shaders").rglob(f"*.{suffix}"))
            self.assertEqual(sum(label in record for record in records), len(shaders), label)
