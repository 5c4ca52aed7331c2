"""Shaders as students write them, with names that the engine has and with mistakes: a page renders what the backend `compute` does, and
says what to do."""

import json
import random
import shutil
import subprocess
import unittest

from program import BINARIES, ProgramTest  # first: it finds the others
import numpy as np
from book import live
from browser import CHROMIUM, Browser
from image_files import Exr
from project import CHAPTERS, text_of
from tools_path import PROJECT

STUDENTS = PROJECT / "tests/browser/students"
SCENE, SIZE, SAMPLES, LENGTH = "cornell_box", 16, 2, ["--max-path-length", 2]
RANDOM_SHADERS = 6
# What the scene's arrays are in a shader where nothing hides them.
SCENES = {
    "materials": "materials[{}].diffuse_albedo.y",
    "positions": "abs(positions[{}].x)",
    "triangles": "float(triangles[{}].z)",
    "triangle_materials": "float(triangle_materials[{}])",
}
NAMES = [*SCENES, "samples", "film", "ray_counters", "normals", "children", "media"]
MOST_DIFFERENT = 2  # pixels of 256: where rounding decides which triangle a ray meets


def random_shader(pick):
    """A shader of nested scopes, whose variables and arrays have the engine's names and hide each other and the scene's arrays."""

    def value(scopes):
        name = pick.choice(NAMES)
        kind = next((scope[name] for scope in reversed(scopes) if name in scope), None)
        index = pick.choice(["0", "1", "1u"])
        own = {"array": f"{name}[{index}]", "vector": f"{name}[{index}]", "number": name, "index": f"float({name})"}.get(kind)
        return own or SCENES.get(name, "0.5").format(index)

    def block(scopes, depth):
        scopes, lines = [*scopes, {}], []
        for _ in range(pick.randint(3, 6)):
            name, kind = pick.choice(NAMES), pick.choice(
                ["declare", "declare", "add", "add", "set", "block", "loop", "condition"]
            )
            if kind == "declare" and name not in scopes[-1]:
                what = pick.choice(["array", "vector", "number"])
                lines += {
                    "array": [f"float {name}[2] = float[2]({value(scopes)}, {value(scopes)});"],
                    "vector": [f"vec2 {name} = vec2({value(scopes)}, 0.25);"],
                    "number": [f"float other_{depth}_{len(lines)} = 1.0, {name} = {value(scopes)};"],
                }[what]
                scopes[-1][name] = what
            elif kind == "set" and (own := next((scope[name] for scope in reversed(scopes) if name in scope), None)) in (
                "array",
                "vector",
            ):
                lines.append(f"{name}[{pick.randint(0, 1)}] = {value(scopes)};")
            elif depth < 4 and kind in ("block", "condition"):
                head = "" if kind == "block" else f"if (sum.x {pick.choice('<>')} {value(scopes)}) "
                lines += [f"{head}{{", *block(scopes, depth + 1), "}"]
            elif depth < 4 and kind == "loop":
                lines += [
                    f"for (int {name} = 0; {name} < 2; ++{name}) {{ {{",
                    *block([*scopes, {name: "index"}], depth + 1),
                    "} }",
                ]
            else:
                lines.append(f"sum += vec3({value(scopes)}, {value(scopes)}, 0.125);")
        return lines

    return (
        "\n".join(
            ["vec3 path_trace(Ray ray, inout uvec2 seed) {", "vec3 sum = vec3(0.0);", *block([], 0), "return sum + 1.0;", "}"]
        )
        + "\n"
    )


@unittest.skipUnless(CHROMIUM, "needs Chromium, which ./lab test installs")
class StudentsPage:
    def setUp(self):
        super().setUp()
        browser = self.enterContext(Browser())
        chapter = CHAPTERS[3]
        arrays, parameters, _, _ = live.dump(self.folder / "dump", chapter, SCENE, *LENGTH)
        scripts = ["sources.js", *live.SCRIPTS[: live.SCRIPTS.index("renderer.js") + 1], "one_film.js"]
        for name in scripts[1:-1]:
            shutil.copy(live.HERE / name, self.folder)
        shutil.copy(PROJECT / "tests/browser/one_film.js", self.folder)
        told = {"sources": live.shaders(), "scene": arrays, "words": parameters, "data": {}}
        (self.folder / "sources.js").write_text(f"var live = {json.dumps(told)};", encoding="utf-8")
        (self.folder / "page.html").write_text(
            "<canvas></canvas>" + "".join(f'<script src="{name}"></script>' for name in scripts), encoding="utf-8"
        )
        browser.visit((self.folder / "page.html").as_uri())
        self.chapter, self.browser = chapter, browser

    def on_page(self, file):
        folder = file.with_suffix("")
        helpers = {
            f"chapters/{self.chapter}/{helper.relative_to(folder).as_posix()}": text_of(helper)
            for helper in folder.rglob("*.glsl")
        }
        texts = json.dumps({f"chapters/{self.chapter}/path_trace.glsl": text_of(file)} | helpers)
        return np.reshape(
            self.browser.evaluate(f"live.film('{self.chapter}', live.scene, live.words, {texts}, [{SIZE}, {SIZE}], {SAMPLES})"),
            (-1, 3),
        )

    def error(self, text):
        file = self.folder / "wrong.glsl"
        file.write_text(text, encoding="utf-8")
        with self.assertRaises(RuntimeError) as refused:
            self.on_page(file)
        return (
            str(refused.exception)
            .splitlines()[0]
            .removeprefix("ShaderError: ")
            .replace(f"chapters/{self.chapter}/path_trace.glsl", "FILE")
        )


class StudentsErrorsTest(StudentsPage, ProgramTest):
    HEAD = "vec3 path_trace(Ray ray, inout uvec2 seed) {\n"

    def test_they_name_the_place_and_what_to_do(self):
        for body, place, advice in (
            ("return 0.5 * path_trace(ray, seed);\n}", 1, "path_trace.. calls itself: GLSL has no recursion, write a loop"),
            ("/* hm\nreturn vec3(1.0);\n}", 2, "this comment is never closed"),
            ("for (int i = 0; i < 3; ++i) {\nreturn vec3(1.0);\n}", 1, "this . is never closed: a } is missing"),
            ("return vec3(1.0);\n}\n}", 4, "this } closes nothing"),
            ("vec3 x = 0.5;\nreturn x;\n}", 2, r"vec3\(x\) makes three of one"),
            ("return 0.5;\n}", 2, r"vec3\(x\) makes three of one"),
            ("float x = ray.direction;\nreturn vec3(x);\n}", 2, "v.x takes one of three"),
            ("return vec3(2 * ray.direction);\n}", 2, r"2\.0 \* x instead of 2 \* x"),
            ("return vec3(1.5 % 1.0);\n}", 2, r"mod\(x, y\)"),
            ("float a[2] = {1.0, 2.0};\nreturn vec3(a[0]);\n}", 2, r"float\[2\]\(1.0, 2.0\)"),
            ("float sample = 1.0;\nreturn vec3(sample);\n}", 2, "choose another"),
            ("if (ray.origin.x > 0.0)\ndiscard;\nreturn vec3(1.0);\n}", 3, "discard is for pixels of triangles"),
            ("#ifdef SOMETHING\nreturn vec3(1.0);\n}", 2, "this condition has no #endif"),
            ("int i = 0;\nfloat a[2][3];\nreturn vec3(a[i][i]);\n}", 3, r"write float a\[6\] and a\[3 \* i \+ j\] instead"),
            ("float[2][3] a;\nreturn vec3(a[0][0]);\n}", 2, "write float a.6. "),
            ("float[3] a[2];\nreturn vec3(a[0][0]);\n}", 2, "write float a.6. "),
            ("struct Table {\nfloat a[2][3];\n} table;\nreturn vec3(table.a[0][0]);\n}", 3, "write float a.6. "),
            ("#define TEXT(x) #x\nreturn vec3(1.0);\nTEXT(a)\n}", 4, "# has no meaning here"),
            ("#define JOIN(x, y) x##y\nreturn vec3(JOIN(1.0,));\n}", 3, "## needs a word on both sides"),
            ("#define JOIN(x, y) x##y\nreturn vec3(JOIN(+, x));\n}", 3, r"\+ ## x is no word of GLSL"),
            ("#if 0\nit's \"open\n#endif\nreturn vec3(1.0);\n}", 3, "this text is never closed"),
            ("float größe = 1.0;\nreturn vec3(1.0);\n}", 2, "'ö' is no ASCII character"),
            ("return vec3(1.0)\n}", 3, "is a semicolon or a bracket missing here or before?"),
        ):
            with self.subTest(body=body):
                self.assertRegex(self.error(self.HEAD + body + "\n"), rf"^FILE:{place}: .*{advice}")
        calls = "float g(float x);\nfloat f(float x) { return g(x); }\nfloat g(float x) { return f(x); }\n"
        self.assertRegex(
            self.error(f"{calls}{self.HEAD}return vec3(f(1.0));\n}}"),
            r"^FILE:\d: [fg]\(\) calls itself by way of [fg]\(\): GLSL has no recursion",
        )
        self.assertRegex(
            self.error(f"float first(float a[2][3]) {{ return a[0][0]; }}\n{self.HEAD}return vec3(1.0);\n}}"),
            "^FILE:1: .*write float a.6. ",
        )
        for name in ("path_tracer(Ray ray, inout uvec2 seed)", "path_trace(Ray ray)"):
            self.assertIn(
                "the shader has to define vec3 path_trace(Ray ray, inout uvec2 seed)",
                self.error(f"vec3 {name} {{ return vec3(1.0); }}"),
            )


class StudentsNamesTest(StudentsPage, ProgramTest):
    def in_program(self, file):
        folder = self.folder / file.stem
        shutil.copytree(file.with_suffix(""), folder) if file.with_suffix("").exists() else folder.mkdir()
        shutil.copy(file, folder / "path_trace.glsl")
        output = folder / "picture.exr"
        command = [
            BINARIES / self.chapter,
            SCENE,
            *LENGTH,
            "--width",
            SIZE,
            "--height",
            SIZE,
            "--samples",
            SAMPLES,
            "--backend",
            "compute",
            "--shader",
            f"path_trace.glsl={folder / 'path_trace.glsl'}",
            "--headless",
            "--quiet",
            "--output",
            output,
        ]
        process = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        self.assertEqual(process.returncode, 0, process.stderr)
        return np.array(Exr(output).pixels()).reshape(3, -1).T

    def assert_same(self, file):
        with self.subTest(shader=file.name):
            expected = self.in_program(file)
            self.assertGreater(expected.mean(), 0)
            different = (np.abs(self.on_page(file) - expected) > 1e-4 * (1 + np.abs(expected))).any(axis=1).sum()
            self.assertLessEqual(different, MOST_DIFFERENT, text_of(file))

    def test_pictures_are_those_of_compute(self):
        files = sorted(STUDENTS.glob("*.glsl"))
        self.assertGreater(len(files), 10)
        for file in files:
            self.assert_same(file)

    def test_random_scopes(self):
        for seed in range(RANDOM_SHADERS):
            file = self.folder / f"random_{seed}.glsl"
            file.write_text(random_shader(random.Random(seed)), encoding="utf-8")
            self.assert_same(file)

    def test_what_the_programs_refuse(self):
        for declaration, name in (
            ("struct Film { float x; };", "Film"),
            ("vec3 positions(vec3 p) { return p; }", "positions"),
            ("float materials[2];", "materials"),
        ):
            text = f"{declaration}\nvec3 path_trace(Ray ray, inout uvec2 seed) {{ return vec3(1.0); }}\n"
            self.assertRegex(self.error(text), f"^FILE:1: '{name}' : redefinition")
