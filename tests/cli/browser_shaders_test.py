"""Every estimator of the course is also a shader of WebGL 2: GLSL ES 3.00, which is stricter than what other ways compile."""

import json
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

from tools_path import PROJECT, TOOLS  # first: it finds the others
from book import live
from browser import CHROMIUM, Browser
from course.mistakes import complete, plant, records, shader_of
from includes import continued, shaders_of
from project import CHAPTERS, course, description, read_json, text_of

NODE, VALIDATOR = shutil.which("node"), shutil.which("glslangValidator")
STACK = "BVH_STACK_SIZE 32"
# What scenes may have: the Cornell box, meshes with everything, a sky, and rough materials.
FEATURES = {
    "lamps": [STACK, "FEATURE_LIGHT_TRIANGLES"],
    "meshes": [
        STACK,
        "FEATURE_TRANSFORMS",
        "FEATURE_VERTEX_NORMALS",
        "FEATURE_TEXTURES",
        "TEXTURE_COUNT 1",
        "FEATURE_LIGHT_TRIANGLES",
        "FEATURE_DOUBLE_SIDED",
        "FEATURE_SPECULAR",
        "FEATURE_DIELECTRICS",
        "FEATURE_ABSORPTION",
    ],
    "probe": [STACK, "FEATURE_LIGHT_PROBE", "FEATURE_LIGHT_PROBE_CELLS", "FEATURE_LIGHT_TRIANGLES"],
    "microfacets": [
        STACK,
        "FEATURE_MICROFACETS",
        "FEATURE_MULTIPLE_SCATTERING",
        "FEATURE_LIGHT_TRIANGLES",
        "FEATURE_DIELECTRICS",
    ],
}
FEATURES["everything"] = [
    STACK,
    "TEXTURE_COUNT 1",
    "SPLATS",
    *sorted({name for text in live.shaders().values() for name in re.findall(r"\bFEATURE_\w+", text)}),
]
FILTERS = {
    name: [f"FILTER {value}"]
    for chapter in course()
    for choice in description(CHAPTERS[chapter]).get("choices", [])
    if "passes" in choice
    for name, value in choice["values"][1:]
}
NOTEBOOK = PROJECT / "notebook"
# What a browser has against a fragment shader.
COMPILE = """(text => {
    const gl = document.createElement("canvas").getContext("webgl2"), shader = gl.createShader(gl.FRAGMENT_SHADER);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    return gl.getShaderInfoLog(shader);
})(%s)"""


def path_of(file):
    return file.relative_to(PROJECT).as_posix()


def mistakes():
    """Each mistake of the chapters and the engine: (chapter, name, {path: text})."""
    everything = records()
    for chapter, those in everything.items():
        for record in those:
            record = complete(record, everything)
            file = shader_of(chapter, record)
            if file.suffix == ".glsl" and "solutions" not in file.parts:
                name = f"mistake {record['name']}"
                yield chapter or 10, name, {path_of(file): plant(text_of(file), record["find"], record["replace"], name)}


def others():
    """What students and variants wrote, where there is a notebook: the same, with one text for each file they hand in."""
    for folder in NOTEBOOK.glob("submissions/*/*/"):
        chapter = read_json(folder / "submission.json")["chapter"]
        own = {file.name: file for file in reversed(shaders_of(chapter))}
        yield chapter, path_of(folder), {
            path_of(own.get(file.name, PROJECT / "chapters" / CHAPTERS[chapter] / file.name)): text_of(file)
            for file in folder.glob("*.glsl")
        }
    for file in NOTEBOOK.glob("variants/*/variants.json"):
        for variant in read_json(file):
            own = PROJECT / "chapters" / file.parent.name / variant.get("shader", "path_trace.glsl")
            yield int(file.parent.name[:2]), f"variant {variant['file']}", {path_of(own): text_of(file.parent / variant["file"])}


class ShadersInBrowser:
    def translate(self, jobs, **program):
        """Writes files, as {file: (chapter, name, changed texts, feature)}. `program`: isRecorder or main of translate.js."""
        task = {
            "sources": live.shaders(),
            "jobs": [
                {
                    "file": str(file),
                    "chapter": CHAPTERS[chapter],
                    "texts": changed,
                    "defines": (FEATURES | FILTERS)[feature],
                    **program,
                }
                for file, (chapter, _, changed, feature) in jobs.items()
            ],
        }
        subprocess.run(
            [NODE, PROJECT / "tests/browser/translate.js", TOOLS / "book/live"], input=json.dumps(task), text=True, check=True
        )

    def errors(self, texts, features=tuple(FEATURES), **program):
        """The errors of (chapter, name, changed texts), by name and features."""
        with tempfile.TemporaryDirectory() as folder:
            jobs = {
                str(Path(folder) / f"{i}_{feature}.frag"): (chapter, name, changed, feature)
                for i, (chapter, name, changed) in enumerate(texts)
                for feature in features
            }
            self.translate(jobs, **program)
            output = subprocess.run([VALIDATOR, *jobs], capture_output=True, text=True).stdout
        self.assertGreater(len(jobs), 0)
        found, file = {}, None
        for line in output.splitlines():
            file = line if line in jobs else file
            if line.startswith("ERROR: "):
                found.setdefault(f"{jobs[file][1]}, {jobs[file][3]}", line)
        return found


@unittest.skipUnless(NODE and VALIDATOR, "needs nodejs and glslang-tools, which ./lab test installs")
class ShadersInBrowserTest(ShadersInBrowser, unittest.TestCase):
    def test_lines_know_their_places(self):
        path = path_of(PROJECT / "chapters" / CHAPTERS[3] / "path_trace.glsl")
        text = "#define PROBE(name, \\\n              value) int name = value\n/* two\nlines */ " + text_of(PROJECT / path)
        text = text.replace("for (", "int probe_1;\nfor\n(\n", 1).replace(
            "vec3 throughput", "PROBE(probe_2,\n2); int probe_3 = 1; vec3 throughput", 1
        )
        text += "#if 0\nint probe_0;\n#endif\nint probe_4;\n"
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "places"
            self.translate({file: (3, "", {path: text}, "lamps")})
            found = re.findall(r"\b(probe_\d).*// (\S+):(\d+)$", file.read_text(encoding="utf-8"), re.MULTILINE)
        lines = {name: 1 + text[: text.index(name)].count("\n") for name in ("probe_1", "probe_2", "probe_3", "probe_4")}
        self.assertEqual(sorted(found), [(name, path, str(line)) for name, line in lines.items()])

    def test_the_list_of_files_that_chapters_replace_is_complete(self):
        """Nobody else has a file with the name of one of the engine's, or of a chapter that this one continues."""
        replaceable = {Path(name).name for name in read_json(PROJECT / live.REPLACEABLE)}
        files = [file for room in ("engine", "world") for file in (PROJECT / "shaders" / room).rglob("*.glsl")]
        included = {name for file in files for name in re.findall(r'^#include "(\w+\.glsl)"', text_of(file), re.MULTILINE)}
        engine = [{file.name for file in files}, included]
        replaced = set()
        for chapter in course():
            own, *others = (
                {file.name for file in folder.glob("*.glsl")} for folder in continued(PROJECT / "chapters" / CHAPTERS[chapter])
            )
            replaced |= own & set().union(*others, *engine) - {"path_trace.glsl"}
        self.assertEqual(replaced, replaceable)

    def test_every_chapter_compiles(self):
        self.assertEqual(self.errors((chapter, CHAPTERS[chapter], {}) for chapter in CHAPTERS), {})

    @unittest.skipUnless(CHROMIUM, "needs Chromium, which ./lab test installs")
    def test_chromium_compiles_every_chapter(self):
        """It forbids more than the language does, such as `?:` between structures."""
        with tempfile.TemporaryDirectory() as folder, Browser() as browser:
            jobs = {Path(folder) / f"{name}.frag": (chapter, name, {}, "everything") for chapter, name in CHAPTERS.items()}
            self.translate(jobs)
            for file, (_, name, *_) in jobs.items():
                with self.subTest(chapter=name):
                    self.assertEqual(browser.evaluate(COMPILE % json.dumps(file.read_text(encoding="utf-8"))), "")

    def test_the_recorder_of_every_chapter_compiles(self):
        self.assertEqual(self.errors(((chapter, CHAPTERS[chapter], {}) for chapter in CHAPTERS), isRecorder=True), {})

    def test_filters_compile(self):
        shaders = live.shaders()
        filters = {path: int(path.split("/")[1][:2]) for path in shaders if re.fullmatch(r"chapters/\w+/filter\.glsl", path)}
        texts = [(chapter, path, {}) for path, chapter in filters.items()]
        for chapter in filters.values():
            piece = live.exercise_of(CHAPTERS[chapter], shaders)
            text = piece and shaders[piece["file"]].replace(piece["find"], piece["replace"])
            texts += [(chapter, "exercise", {piece["file"]: text})] if piece else []
        texts += [mistake for mistake in mistakes() if mistake[0] in filters.values()]
        self.assertEqual(self.errors(texts, tuple(FILTERS), main="shaders/engine/filter.frag"), {})

    def test_solutions_and_exercises_compile(self):
        texts = [
            (int(file.parts[-3][:2]), path_of(file), {f"chapters/{file.parts[-3]}/path_trace.glsl": text_of(file)})
            for file in PROJECT.glob("chapters/*/solutions/*.glsl")
        ]
        shaders = live.shaders()
        exercises = {chapter: live.exercise_of(CHAPTERS[chapter], shaders) for chapter in course()}
        for chapter, piece in ((chapter, piece) for chapter, piece in exercises.items() if piece):
            text = shaders[piece["file"]].replace(piece["find"], piece["replace"])
            texts.append((chapter, f"exercise {chapter}", {piece["file"]: text}))
        self.assertEqual(self.errors(texts), {})

    def test_names_of_the_engine_may_be_a_students(self):
        def texts_of(file):
            helpers = {
                helper.relative_to(file.with_suffix("")).as_posix(): helper for helper in file.with_suffix("").rglob("*.glsl")
            }
            return {
                f"chapters/{CHAPTERS[3]}/{name}": text_of(each) for name, each in ({"path_trace.glsl": file} | helpers).items()
            }

        texts = [(3, file.name, texts_of(file)) for file in (PROJECT / "tests/browser/students").glob("*.glsl")]
        self.assertEqual(self.errors(texts, ["lamps", "meshes"]), {})

    @unittest.skipUnless(NOTEBOOK.exists(), "there is no notebook")
    def test_what_students_wrote_compiles(self):
        self.assertEqual(self.errors(others(), ["meshes", "probe"]), {})

    def test_what_only_other_ways_compile_is_refused(self):
        file = f"chapters/{CHAPTERS[1]}/path_trace.glsl"
        for wrong in ("float x = 1;", "float y = 2.0 * 3;", "float ω = 1.0;", '#include "missing.glsl"'):
            text = f"{text_of(PROJECT / file)}\n{wrong}\n"
            self.assertEqual(len(self.errors([(1, wrong, {file: text})], ["lamps"])), 1, wrong)


@unittest.skipUnless(NODE and VALIDATOR, "needs nodejs and glslang-tools, which ./lab test installs")
class ShadersInBrowser_all(ShadersInBrowser, unittest.TestCase):
    def test_mistakes_compile(self):
        self.assertEqual(self.errors(mistakes(), ["meshes", "probe"]), {})
