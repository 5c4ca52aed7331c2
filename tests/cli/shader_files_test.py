"""Shaders as people hand them in: written on other systems, and with includes that lead elsewhere."""

import os
import re
import subprocess
from pathlib import Path

from program import CHAPTER as CHAPTER_PROGRAM
from program import BINARIES, PROJECT, UNOPTIMISED, ProgramTest  # first: it finds the tools
from image_files import Exr

CHAPTER = "01_uniform_sampling"
GREY = "vec3 path_trace(Ray ray, inout uvec2 seed) { return get_grey(); }\n"
# Text of chapter 1 -> its replacement, how many lines further down the error is reported, and the message.
MISTAKES = {
    "vec3 path_trace(": ("vec3 pathtrace(", None, "'path_trace'", r"the shader has to define vec3 path_trace\(Ray"),
    "vec3 throughput = vec3(1.0);": ("vec3 throughput = vec3(1.0)", 1, "'' : +syntax error", "is a semicolon missing"),
    "throughput *= PI": ("througput *= PI", 0, "'througput'", "is it misspelt"),
    "get_shading_data(": ("get_shading_daat(", 0, "'get_shading_daat'", "is the name misspelt"),
    "get_random_numbers(seed)": ("get_random_numbers()", 0, "'get_random_numbers'", ".*argument"),
    "vec3 radiance = vec3(0.0);": ("vec3 radiance = 0.0;", 0, "'=' ", ".*same type"),
    "return radiance;": ("return radiance; }", 1, "'' : +syntax error", ".*} too many"),
}
HELPER = "vec3 get_grey() { return vec3(0.5); }\n"


class ShaderFiles(ProgramTest):
    """Chapter 1 with another shader."""

    def setUp(self):
        super().setUp()
        self.shader = self.write("mine/path_trace.glsl", "")
        self.arguments = [
            "quad.json",
            "--width=4",
            "--height=4",
            "--samples=1",
            "--backend=compute",
            "--shader=path_trace.glsl=mine/path_trace.glsl",
        ]

    def beside(self, name, contents):
        """Writes a file next to the shader."""
        return self.write(Path("mine") / name, contents)

    def assert_renders(self, shader):
        self.shader.write_bytes(shader)
        self.render(*self.arguments, "--output=grey.exr", environment=UNOPTIMISED)
        self.assertEqual(Exr(self.folder / "grey.exr").mean(), [0.5, 0.5, 0.5])

    def assert_shader_refused(self, shader, *words):
        self.shader.write_bytes(shader if isinstance(shader, bytes) else shader.encode())
        self.assert_refused([*self.arguments, "--output=no.exr"], *words)

    def test_a_loop_that_finishes_no_sample_gives_a_black_picture(self):
        """As chapter 10's exercise does before it is solved, with one thread a pixel."""
        loop = "10_path_regeneration/sample_loop.glsl"
        self.write(f"mine/{loop}", "void render_samples(uvec2 position, uint first, uint end, uint step) {}\n")
        arguments = [*self.arguments[:-1], f"--shader={loop}=mine/{loop}", "--max-threads-per-pixel=1", "--output=black.exr"]
        self.render(*arguments, program=BINARIES / "10_path_regeneration", environment=UNOPTIMISED)
        self.assertEqual(Exr(self.folder / "black.exr").mean(), [0, 0, 0])

    def test_line_ends_and_byte_order_mark_of_windows(self):
        self.beside("helper.glsl", b"\xef\xbb\xbf// A helper\r\n" + HELPER.replace("\n", "\r\n").encode())
        shader = '#include "helper.glsl"\n// é, in a comment\n#define LONG \\\n    1\n' + GREY
        for mark in (b"", b"\xef\xbb\xbf"):
            for line_end in ("\n", "\r\n"):
                self.assert_renders(mark + shader.replace("\n", line_end).encode())

    def test_what_is_no_ascii_in_code_is_reported_with_its_line(self):
        for name in ("π", "“"):
            for encoding in ("utf-8", "cp1253"):
                text = f"// one\r\nfloat {name} = 3.14;\r\n{GREY}".encode(encoding, "replace")
                self.assert_shader_refused(text, r"path_trace\.glsl:2: a character that is not ASCII, ")

    def test_the_commonest_mistakes_come_with_advice(self):
        """One line each, since the rest of the compiler's output follows from it."""
        own = (PROJECT / "chapters" / CHAPTER / "path_trace.glsl").read_text(encoding="utf-8")
        line = {text: number for number, full in enumerate(own.split("\n"), 1) for text in MISTAKES if text in full}
        for right, (wrong, below, word, advice) in MISTAKES.items():
            with self.subTest(wrong):
                self.assertEqual(own.count(right), 1)
                place = rf"path_trace\.glsl:{line[right] + below}: " if below is not None else r"sample_loop\.glsl:\d+: "
                self.assert_shader_refused(own.replace(right, wrong), place + word + r".* \(" + advice)

    def test_recursion_names_its_functions(self):
        for helpers, names in (
            ("vec3 one(int n) { return n == 0 ? vec3(0) : one(n - 1); }\n", r"one\(\) calls one\(\)"),
            (
                "vec3 two(int n);\nvec3 one(int n) { return two(n); }\nvec3 two(int n) { return one(n - 1); }\n",
                r"(one\(\) calls two|two\(\) calls one)\(\)",
            ),
        ):
            self.assert_shader_refused(helpers + GREY.replace("get_grey()", "one(3)"), names + ".* write a loop")

    def test_what_only_other_scenes_have_is_not_called_misspelt(self):
        for use in ("uint(light_triangles.length())", "light_triangles[0].alias"):
            shader = f"vec3 path_trace(Ray ray, inout uvec2 seed) {{ return vec3(float({use})); }}\n"
            advice = r"path_trace\.glsl:1: .*\(this scene lacks what it belongs to: put #ifdef FEATURE_LIGHT_TRIANGLES before and #endif "
            self.assert_shader_refused(shader, advice)

    def test_includes_are_small_files_below_the_tree(self):
        outside = self.write("outside.glsl", HELPER)
        folder = self.shader.parent
        os.mkfifo(folder / "pipe")
        (folder / "link").symlink_to(outside)
        (folder / "link_to_a_folder").symlink_to(self.folder)
        (folder / "folder").mkdir()
        self.beside("large.glsl", HELPER + " " * (4 << 20))
        place, outside_words = r"path_trace\.glsl:2: .*", ".* is outside of the shader's folder"
        for name, before, after in (
            ("/dev/zero", place, outside_words),
            (str(outside), place, outside_words),
            ("../outside.glsl", place, outside_words),
            ("link", place, outside_words),
            ("link_to_a_folder/outside.glsl", place, outside_words),
            ("folder/../../outside.glsl", place, outside_words),
            ("nothing", place + "cannot find .*", '"'),
            ("a" * 5000, place + "cannot find .*", ""),
            ("pipe", "", ": not a regular file"),
            ("folder", "", ": not a regular file"),
            ("large.glsl", "", ": the file has 4 MiB, the limit is 1 MiB"),
        ):
            self.assert_shader_refused(f'// one\n#include "{name}"\n{GREY}', before + re.escape(name[:40]) + after)

    def test_includes_in_the_tree_may_be_links(self):
        self.beside("helper.glsl", HELPER)
        (self.shader.parent / "link").symlink_to("helper.glsl")
        self.assert_renders(f'#include "link"\n#include "../mine/helper.glsl"\n{GREY}'.encode())

    def test_paths_that_no_line_directive_can_hold(self):
        for name in ('a "b"', "a\\b"):
            shader = self.write(Path(name) / "path_trace.glsl", GREY)
            self.assert_refused(
                [*self.arguments[:-1], f"--shader=path_trace.glsl={shader}", "--output=no.exr"],
                re.escape(name),
                'must not contain " or',
            )

    def test_a_name_or_a_file_that_is_not_there(self):
        for given, words in (
            ("path_trace.glsl", 'no file ""'),
            ("path_trace.glsl=nothing.glsl", 'no file "nothing.glsl"'),
            ("path_trace.glsl=mine", 'no file "mine"'),
        ):
            self.assert_refused(["quad.json", f"--shader={given}", "--output=no.exr"], f"--shader {given}: there is {words}")

    def test_what_the_chapter_does_not_read_cannot_be_replaced(self):
        self.write("wrong.glsl", "not GLSL")
        for name, place in (
            ("nothing.glsl", "01_uniform_sampling/nothing.glsl"),
            ("lights.glsl", "01_uniform_sampling/lights.glsl"),
            ("chapter.json", "01_uniform_sampling/chapter.json"),
            ("03_nothing/path_trace.glsl",) * 2,
            ("14_many_lights/light_tree.glsl",) * 2,
            ("../shaders/world/lights.glsl",) * 2,
        ):
            self.assert_refused(
                ["quad.json", f"--shader={name}=wrong.glsl", "--output=no.exr"],
                f'the chapter does not read "{place}": write NAME=FILE, where NAME is one of brdf.glsl, camera.glsl, path_trace',
            )

    def test_another_shader_is_another_estimator(self):
        """Wherever its file is: what it rendered goes on with the same text, but not with the chapter's own shader."""
        self.assert_renders((HELPER + GREY).encode())
        self.write("a.glsl", HELPER + GREY)
        same = ["quad.json", "--width=4", "--height=4", "--samples=2", "--backend=compute", "--resume=grey.exr"]
        self.render(*same, "--shader=path_trace.glsl=a.glsl", "--output=more.exr", environment=UNOPTIMISED)
        self.assert_refused([*same, "--output=no.exr"], "shader")

    def test_a_batch_has_a_shader_for_each_picture(self):
        lines = []
        for name, grey in (("a", "0.25"), ("b", "0.5"), ("c", "0.25")):
            self.write(f"{name}.glsl", GREY.replace("get_grey()", f"vec3({grey})"))
            lines.append(" ".join([*self.arguments[:-1], f"--shader=path_trace.glsl={name}.glsl", f"--output={name}.exr\n"]))
        ended = subprocess.run(
            [CHAPTER_PROGRAM, "--batch"], input="".join(lines), cwd=self.folder, capture_output=True, text=True
        )
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual([Exr(self.folder / f"{name}.exr").mean()[0] for name in "abc"], [0.25, 0.5, 0.25])

    def test_long_lines(self):
        blanks = b" " * 300000
        self.beside("helper.glsl", HELPER)
        self.assert_renders(b"//" + blanks + b"\n" + blanks + b'#include "helper.glsl" //' + blanks + b"\n" + GREY.encode())

    def test_a_shader_that_is_too_large(self):
        self.assert_shader_refused(GREY + " " * (4 << 20), r"path_trace\.glsl", "MiB")
