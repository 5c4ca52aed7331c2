"""docs/shader.md lists all that the chapters use of the shared shaders, and follows their comments."""

import re
import shutil
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from tools_path import PROJECT  # first: it finds the others
import includes
from docs import shader_table
from project import UserError

PAGE = (PROJECT / "docs/shader.md").read_text(encoding="utf-8")
LISTED = set(re.findall(r"\w+(?:\.\w+)?", " ".join(re.findall(r"^\| `([^`]+)` \|", PAGE, re.MULTILINE))))


def code_of(files):
    """The words of some sources, without comments and directives that include files."""
    return "\n".join(re.sub(r"//.*|#include.*", "", file.read_text(encoding="utf-8")) for file in files)


CHAPTERS = code_of(PROJECT.glob("chapters/*/*.glsl"))
SHARED = code_of(
    [*PROJECT.glob("shaders/world/**/*.glsl"), *PROJECT.glob("shaders/engine/**/*.glsl"), PROJECT / "shaders/interface.h"]
)


class ShaderPageTest(unittest.TestCase):
    def test_has_every_function_that_chapters_call(self):
        called = set(re.findall(r"\b(\w+)\(", CHAPTERS)) & set(re.findall(r"^\w+ (\w+)\(", SHARED, re.MULTILINE))
        self.assertGreater(len(called), 25)
        self.assertEqual(called - LISTED, set())

    def test_has_every_constant_struct_and_parameter(self):
        constants = set(re.findall(r"\b(?!FEATURE_|SPLATS\b)[A-Z][A-Z_]+\b", CHAPTERS)) & set(
            re.findall(r"(?:\w+|#define) ([A-Z][A-Z_]+)\b", SHARED)
        )
        structs = set(re.findall(r"\b[A-Z]\w+\b", CHAPTERS)) & set(re.findall(r"^struct (\w+)", SHARED, re.MULTILINE))
        parameters = {f"parameters.{name}" for name in re.findall(r"\bparameters\.(\w+)", CHAPTERS)}
        for names in (constants, structs, parameters):
            self.assertGreater(len(names), 4)
            self.assertEqual(names - LISTED, set())

    def test_has_every_member_of_a_struct(self):
        lines = re.search(r"^struct ShadingData \{(.*?)^\};", SHARED, re.MULTILINE | re.DOTALL)[1]
        members = re.findall(r"^ +\w+ (\w+);", lines, re.MULTILINE)
        self.assertGreater(len(members), 15)
        self.assertEqual({f"ShadingData.{name}" for name in members} - LISTED, set())

    def test_names_the_chapter_that_introduces_a_name(self):
        for code, chapter in (
            ("get_brdf", 1),
            ("is_occluded", 3),
            ("happens", 5),
            ("ShadingData.transmittance", 6),
            ("sample_phong", 7),
            ("parameters.splitting_factor", 4),
            ("get_random_words", 9),
            ("Microfacets.mean_albedo", 11),
        ):
            self.assertRegex(
                PAGE,
                rf"(?m)^\| `[^`]*\b{re.escape(code)}\b[^`]*` .* \[{chapter}\]\(\.\./chapters/{chapter:02}_\w+/README\.md\) \|$",
            )

    def test_follows_the_comments_and_misses_none(self):
        with tempfile.TemporaryDirectory() as name:
            root = Path(name).resolve()
            for folder in ("shaders", "chapters"):
                shutil.copytree(PROJECT / folder, root / folder)
            frame, call = root / "shaders/world/frame.glsl", root / "chapters/01_uniform_sampling/path_trace.glsl"
            with mock.patch.object(shader_table, "ROOT", root), mock.patch.object(includes, "ROOT", root):
                self.assertIn(shader_table.shader_tables(), PAGE)
                frame.write_text(
                    frame.read_text(encoding="utf-8").replace("// Rotation matrix Q", "// Turning matrix Q"), encoding="utf-8"
                )
                self.assertIn("Turning matrix Q", shader_table.shader_tables())
                frame.write_text(
                    frame.read_text(encoding="utf-8") + "\nfloat get_half(float x) { return 0.5 * x; }\n", encoding="utf-8"
                )
                self.assertNotIn("get_half", shader_table.shader_tables())
                call.write_text(
                    call.read_text(encoding="utf-8") + "float quarter(float x) { return 0.5 * get_half(x); }\n", encoding="utf-8"
                )
                with self.assertRaisesRegex(
                    UserError, r"^shaders/world/frame\.glsl: 'float get_half\(float x\)' has no comment: "
                ):
                    shader_table.shader_tables()
