"""A chapter is added by copying a folder and nothing else, as docs/teaching.md says."""

import json
import re
import shlex
import shutil
import subprocess
import sys
import unittest

from image_files import Exr
from program import BINARIES, PROJECT, ProgramTest

SOURCE, COPY = "03_next_event_estimation", "20_light_choice"
# What the copy's estimator is replaced by: a colour that no other chapter shows.
PURPLE = "vec3 path_trace(Ray ray, inout uvec2 seed) { return vec3(0.5, 0.0, 1.0); }\n"


class AddedChapterTest(ProgramTest):
    """The project with one more chapter, configured anew. Only that chapter is built: the framework is as it was."""

    def run_in_tree(self, *command):
        result = subprocess.run(list(map(str, command)), cwd=self.tree, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, f"{command}: {result.stdout[-2000:]}{result.stderr[-2000:]}")
        return result.stdout

    def setUp(self):
        super().setUp()
        self.tree = self.folder / "lab"
        for name in ("chapters", "shaders", "tools", "docs"):
            shutil.copytree(PROJECT / name, self.tree / name)
        for name in ("CMakeLists.txt", "CMakePresets.json", "lab", "README.md"):
            shutil.copy(PROJECT / name, self.tree / name)
        for name in ("common", "assets", "tests"):
            (self.tree / name).symlink_to(PROJECT / name)
        shutil.copytree(self.tree / "chapters" / SOURCE, self.tree / "chapters" / COPY)

    def build(self):
        """The copy's program: compiled and linked as CMake says, but with the framework that is built already."""
        cache = (BINARIES.parent / "CMakeCache.txt").read_text()
        same = [f"-D{name}={re.search(rf'^{name}:.*=(.*)$', cache, re.MULTILINE)[1]}"
                for name in ("CMAKE_BUILD_TYPE", "CMAKE_CXX_FLAGS", "CMAKE_CXX_COMPILER", "LAB_SANITIZE")]
        self.run_in_tree("cmake", "-S", ".", "-B", "build", "-G", "Ninja", "-DLAB_TESTS=OFF", *same)
        commands = self.run_in_tree("ninja", "-C", "build", "-t", "commands", COPY).splitlines()
        own = [command for command in commands if f"{COPY}.dir" in command]
        self.assertEqual(len(own), 2, "one to compile main.cpp and one to link")
        for command in own:
            command = re.sub(r"(?<!\S)(?=lib\w+\.a)", lambda _: shlex.quote(str(BINARIES.parent)) + "/", command)
            folder = re.search(r"-o (\S+)", command)[1]
            (self.tree / "build" / folder).parent.mkdir(parents=True, exist_ok=True)
            subprocess.run(command, shell=True, cwd=self.tree / "build", check=True)
        return self.tree / "build/bin" / COPY

    def test_builds_and_renders_its_own_shader(self):
        program = self.build()
        (self.tree / "chapters" / COPY / "path_trace.glsl").write_text(PURPLE, encoding="utf-8")
        out = self.render("--width=8", "--height=8", "--samples=1", "--output=purple.exr", program=program)
        self.assertTrue(out.startswith(COPY), out)
        picture = Exr(self.folder / "purple.exr")
        self.assertEqual(picture.mean(), [0.5, 0.0, 1.0])
        self.assertEqual(picture.text("chapter"), COPY)
        (self.tree / "chapters" / COPY / "chapter.json").write_text('{"title": "Light choice", "light": true}', encoding="utf-8")
        self.assert_refused(["--output=refused.exr"], r"chapter\.json", '"light"', "light_sampling", program=program)

    def test_is_graded_as_the_chapter_that_it_is_a_copy_of(self):
        shader = self.tree / "chapters" / COPY / "path_trace.glsl"
        check = ["-B", self.tree / "tools", "check", 20, "--runs", 4, "--backend", "compute", "--json"]
        own = shader.read_text(encoding="utf-8")
        for text, verdict in ((own, "correct"), (own.replace("* cos_light", "", 1), "biased")):
            shader.write_text(text, encoding="utf-8")
            _, out, err = self.run_program(*check, program=sys.executable, environment={"LAB_BINARIES": str(BINARIES)})
            self.assertEqual(json.loads(out)["verdict"], verdict, err)

    def test_is_known_to_the_commands_and_pages(self):
        self.assertRegex(self.run_in_tree("./lab", "run"), r"\n +20  \w+")
        self.assertIn(f"+ chapters/{COPY}/path_trace.glsl", self.run_in_tree("./lab", "diff", 20))
        names = self.run_in_tree(sys.executable, "-B", "-c",
                                 "import sys; sys.path.append('tools'); from docs import tables; print(tables.PAGES)")
        self.assertIn(COPY, names)
        self.run_in_tree(sys.executable, "-B", "tools", "tables", "--check")
        description = self.tree / "chapters" / COPY / "chapter.json"
        description.write_text(description.read_text(encoding="utf-8").replace('"title": "', '"title": "My '), encoding="utf-8")
        self.assert_refused(["-B", self.tree / "tools", "check", 20], "chapter 20 has a title of its own", r"learn\.py learn", code=2,
                            program=sys.executable)


if __name__ == "__main__":
    unittest.main()
