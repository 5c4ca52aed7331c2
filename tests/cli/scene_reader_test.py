"""The Python reader that passes scenes to other renderers: it draws what models from elsewhere lack as the chapters do."""

import contextlib
import io

from program import QUAD_OBJ, ProgramTest  # first: it finds the tools
from references.scenes import read_scene


class SceneReaderTest(ProgramTest):
    def read(self, obj):
        """Surfaces of a mesh, and messages about it."""
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            surfaces = read_scene(self.write("model.obj", obj)).surfaces
        return surfaces, said.getvalue()

    def test_what_has_no_material_is_grey(self):
        for old, new, missing in (("quad.mtl", "nowhere.mtl", "nowhere.mtl"), ("usemtl white", "usemtl pink", "pink")):
            with self.subTest(missing=missing):
                (surface,), said = self.read(QUAD_OBJ.replace(old, new))
                self.assertEqual(surface.material.diffuse.tolist(), [0.5] * 3)
                self.assertRegex(said, rf"\Anote: [^\n]*model\.obj:\d: there is no [^\n]*'{missing}'[^\n]*grey\n\Z")

    def test_names_with_spaces_around_them_are_found(self):
        self.write("quad.mtl", "newmtl  white \t\nKd 0.25 0.25 0.25\n")
        (surface,), said = self.read(QUAD_OBJ.replace("usemtl white", "usemtl   white  "))
        self.assertEqual((surface.material.diffuse.tolist(), said), ([0.25] * 3, ""))

    def test_a_material_file_that_is_named_twice_is_read_once(self):
        """As in the chapters: their hash of a scene covers everything they read."""
        model = self.write("model.obj", "mtllib quad.mtl\n" + QUAD_OBJ)
        value = 0xCBF29CE484222325
        for byte in model.read_bytes() + (self.folder / "quad.mtl").read_bytes():
            value = (value ^ byte) * 0x100000001B3 % 2**64
        self.assertEqual(read_scene(model).hash, f"{value:x}")
