"""./lab show: a chapter's whole estimator as one text that renders the same picture."""

import re
import unittest

from image_files import Exr
from program import BINARIES, UNOPTIMISED, ProgramTest  # first: it finds the tools
from includes import named_files
from project import CHAPTERS, ROOT

HEADER = re.compile(r"^// ======== (.*) ========$", re.MULTILINE)
# Each of them shows a file that the one before does not, or leaves out what that one shows.
SHOWN = ((1, "cornell_box"), (7, "glossy"), (11, "microfacets"), (12, "focus"), (13, "smoke"), (14, "lamps"), (14, "cornell_box"))
ROOTS = ("random_words.glsl", "camera.glsl", "brdf.glsl", "path_trace.glsl", "sample_loop.glsl")  # what the engine includes


class ShowTest(ProgramTest):
    def show(self, *arguments):
        code, out, err = self.run_tool("show", *arguments)
        self.assertEqual((code, err), (0, ""))
        return out

    def pieces(self, chapter, text):
        """{file: text} of those that the engine includes: what they include themselves follows, until the next of them begins."""
        named = named_files(ROOT / "chapters" / CHAPTERS[chapter])
        roots = {f"{named[name].parent.name}/{name}" for name in ROOTS}
        found, root = {}, None
        for name, part in zip(*[iter(HEADER.split(text)[1:])] * 2):
            root = name if name in roots and name not in found else root
            found[root] = found.get(root, "") + part
        return found

    def test_the_text_renders_the_same_picture(self):
        for chapter, scene in SHOWN:
            with self.subTest(chapter=chapter, scene=scene):
                options = []
                for name, piece in self.pieces(chapter, self.show(chapter, scene)).items():
                    file = self.write(f"{chapter}_{scene}/{name.replace('/', '_')}", piece)
                    options.append(f"--shader={name}={file}")
                pictures = []
                for shaders in ([], options):
                    self.render(
                        scene,
                        "--width=16",
                        "--height=16",
                        "--samples=2",
                        "--backend=compute",
                        "--output=picture.exr",
                        *shaders,
                        program=BINARIES / CHAPTERS[chapter],
                        environment=UNOPTIMISED,
                    )
                    pictures.append(Exr(self.folder / "picture.exr").pixels())
                self.assertEqual(*pictures)

    def test_the_scene_decides(self):
        """Nothing is shown that it does not compile, and no file of which nothing would be left."""
        plain, smoke = self.show(13, "cornell_box"), self.show(13, "smoke")
        for text in (plain, smoke):
            self.assertNotRegex(text, r"(?m)^ *#(if|el|endif|include)")
        self.assertNotIn("13_media/flights.glsl", plain)
        self.assertIn("13_media/flights.glsl", smoke)
        self.assertIn("07_multiple_importance_sampling/extend_path.glsl", plain)
        self.assertNotIn("07_multiple_importance_sampling/extend_path.glsl", smoke)
        self.assertEqual(self.show(13, "fog"), self.show(13))

    def test_wrong_names_are_refused(self):
        self.assert_tool_refused(["show", 99], "there is no chapter 99")
        self.assert_tool_refused(["show", 1, "nothing"], "nothing")


if __name__ == "__main__":
    unittest.main()
