"""A chapter is added by copying a folder and nothing else, as docs/extending.md says: every command, the C++ tests, the book and
the handout pick it up. The same goes for a folder with its own technique and material."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from image_files import Exr
from program import BINARIES, UNOPTIMISED, ProgramTest, copy_project

SOURCE, COPY = "03_next_event_estimation", "20_light_choice"
# Replaces the copy's estimator: a colour that no other chapter shows.
PURPLE = "vec3 path_trace(Ray ray, inout uvec2 seed) { return vec3(0.5, 0.0, 1.0); }\n"
# For a chapter that has these as well: another map of the square to the hemisphere, and the Lambertian BRDF.
TECHNIQUE = """// Shirley and Chiu's concentric map of the square to the disk, lifted to the hemisphere: density cos θ / π.
vec3 sample_concentrically(vec2 u) {
    vec2 p = 2.0 * u - 1.0;
    bool is_wide = abs(p.x) > abs(p.y);
    float r = is_wide ? p.x : p.y;
    float phi = r == 0.0 ? 0.0 : is_wide ? 0.25 * PI * p.y / p.x : 0.5 * PI - 0.25 * PI * p.x / p.y;
    return vec3(r * cos(phi), r * sin(phi), sqrt(max(1.0 - r * r, 0.0)));
}
"""
MATERIAL = """// The Lambertian BRDF, and the lobe where the scene has one.
vec3 get_own_brdf(ShadingData s, vec3 in_direction) {
    vec3 brdf = s.diffuse_albedo / PI;
#ifdef FEATURE_SPECULAR
    brdf += get_phong_brdf(s, in_direction);
#endif
    return brdf;
}
"""
WRONG = [
    {
        "name": "own-brdf-twice",
        "explanation": "The BRDF is added twice.",
        "find": "vec3 brdf = s.diffuse_albedo / PI;",
        "replace": "vec3 brdf = 2.0 * s.diffuse_albedo / PI;",
    }
]


class Tree:
    """The project with one more chapter, configured from scratch. Only that chapter is built: the framework is unchanged."""

    def run_in_tree(self, *command, **environment):
        result = subprocess.run(
            list(map(str, command)), cwd=self.tree, capture_output=True, text=True, env=os.environ | environment
        )
        self.assertEqual(result.returncode, 0, f"{command}: {result.stdout[-2000:]}{result.stderr[-2000:]}")
        return result.stdout

    @classmethod
    def setUpClass(cls):
        cls.built = Path(cls.enterClassContext(tempfile.TemporaryDirectory())) / COPY

    def setUp(self):
        super().setUp()
        self.tree = self.folder / "lab"
        copy_project(
            self.tree,
            "docs",
            "CMakeLists.txt",
            "CMakePresets.json",
            "Containerfile",
            "LICENSE",
            "lab",
            "README.md",
            ".clang-format",
            linked=("common", "assets", "tests"),
        )
        self.chapter = self.tree / "chapters" / COPY
        shutil.copytree(self.tree / "chapters" / SOURCE, self.chapter)

    def build(self):
        """The copy's program: compiled and linked by CMake, but with the framework that is already built. This also configures
        the tests, which register the mistakes of all folders. It reads the shaders of the tree that it is in: once built, it is
        copied to the others."""
        program = self.tree / "build/bin" / COPY
        if self.built.exists():
            program.parent.mkdir(parents=True)
            return shutil.copy(self.built, program)
        cache = (BINARIES.parent / "CMakeCache.txt").read_text()
        same = [
            f"-D{name}={re.search(rf'^{name}:.*=(.*)$', cache, re.MULTILINE)[1]}"
            for name in ("CMAKE_BUILD_TYPE", "CMAKE_CXX_FLAGS", "CMAKE_CXX_COMPILER", "LAB_SANITIZE")
        ]
        self.run_in_tree("cmake", "-S", ".", "-B", "build", "-G", "Ninja", *same)
        commands = self.run_in_tree("ninja", "-C", "build", "-t", "commands", COPY).splitlines()
        own = [command for command in commands if f"{COPY}.dir" in command]
        self.assertEqual(len(own), 2, "one to compile main.cpp and one to link")
        for command in own:
            command = re.sub(r"(?<!\S)(?=lib\w+\.a)", lambda _: shlex.quote(str(BINARIES.parent)) + "/", command)
            folder = re.search(r"-o (\S+)", command)[1]
            (self.tree / "build" / folder).parent.mkdir(parents=True, exist_ok=True)
            subprocess.run(command, shell=True, cwd=self.tree / "build", check=True)
        shutil.copy(program, self.built)
        return program

    def rename(self, title="My choice of lights", **more):
        """With its own title, the chapter no longer counts as a copy."""
        description = json.loads((self.chapter / "chapter.json").read_text(encoding="utf-8"))
        (self.chapter / "chapter.json").write_text(json.dumps(description | {"title": title} | more), encoding="utf-8")

    def bring_technique_and_material(self):
        """Makes it a chapter of bounces whose folder has functions that no other one has."""
        shutil.rmtree(self.chapter)
        shutil.copytree(self.tree / "chapters/02_cosine_sampling", self.chapter)
        (self.chapter / "sample_hemisphere.glsl").unlink()
        (self.chapter / "sample_concentrically.glsl").write_text(TECHNIQUE, encoding="utf-8")
        (self.chapter / "lambertian.glsl").write_text(MATERIAL, encoding="utf-8")
        (self.chapter / "mistakes.json").write_text(json.dumps(WRONG), encoding="utf-8")
        shader = self.chapter / "path_trace.glsl"
        text = shader.read_text(encoding="utf-8").replace(
            '#include "sample_hemisphere.glsl"', '#include "sample_concentrically.glsl"\n#include "lambertian.glsl"'
        )
        text = text.replace("sample_hemisphere(", "sample_concentrically(").replace("get_brdf(", "get_own_brdf(")
        shader.write_text(text, encoding="utf-8")
        exercise = {
            "file": "lambertian.glsl",
            "first": "vec3 brdf = s.diffuse_albedo / PI;",
            "last": "return brdf;",
            "placeholder": ["// TODO: the BRDF.", "return vec3(0.0);"],
        }
        self.rename("Concentric sampling: a map of another kind", exercise=exercise)

    def run_tests(self, kind, tests):
        """Runs tests of a test program on this tree; at least one must run."""
        binary = self.tree / "bin" / f"{kind}_tests"
        binary.parent.mkdir(exist_ok=True)
        shutil.copy(BINARIES / binary.name, binary)
        out = self.run_in_tree(binary, f"--gtest_filter={tests}", **UNOPTIMISED)
        self.assertRegex(out, r"\[  PASSED  \] [1-9]")

    def check(self, *arguments):
        command = ["-B", self.tree / "tools", "check", 20, "--runs", 4, "--backend", "compute", "--json", *arguments]
        _, out, err = self.run_program(*command, program=sys.executable, environment={"LAB_BINARIES": str(BINARIES)})
        return json.loads(out)["verdict"], err


class AddedChapterTest(Tree, ProgramTest):
    def test_builds_and_renders_its_own_shader(self):
        program = self.build()
        (self.chapter / "path_trace.glsl").write_text(PURPLE, encoding="utf-8")
        out = self.render("--width=8", "--height=8", "--samples=1", "--output=purple.exr", program=program)
        self.assertTrue(out.startswith(COPY), out)
        picture = Exr(self.folder / "purple.exr")
        self.assertEqual(picture.mean(), [0.5, 0.0, 1.0])
        self.assertEqual(picture.text("chapter"), COPY)
        self.rename(light=True)
        self.assert_refused(["--output=refused.exr"], r"chapter\.json", '"light"', "strategies", program=program)

    def test_is_known_to_the_commands_and_pages(self):
        self.assertRegex(self.run_in_tree("./lab", "run"), r"\n +20  \w+")
        difference = self.run_in_tree("./lab", "diff", 20)
        self.assertIn(f"+ chapters/{COPY}/path_trace.glsl", difference)
        self.assertIn("Chapter 3 to 20: 0 lines of code", difference)
        names = self.run_in_tree(
            sys.executable, "-B", "-c", "import sys; sys.path.append('tools'); from docs import tables; print(tables.PAGES)"
        )
        self.assertIn(COPY, names)
        self.run_in_tree(sys.executable, "-B", "tools", "tables", "--check")
        bugs = self.run_in_tree(sys.executable, "-B", "tools", "bug", 20)
        self.assertEqual(bugs.replace("bug 20", "bug 3"), self.run_in_tree(sys.executable, "-B", "tools", "bug", 3))
        self.rename()
        self.assertNotIn("Chapter 3 to 20", self.run_in_tree("./lab", "diff", 20))
        self.assert_refused(
            ["-B", self.tree / "tools", "check", 20],
            "chapter 20 has a title of its own",
            "notebook learn",
            code=2,
            program=sys.executable,
        )

    def test_is_in_the_handout_and_its_exercise_is_a_todo(self):
        self.run_in_tree(sys.executable, "-B", "tools", "handout", 20, self.folder / "handout")
        handed_out = self.folder / "handout/chapters" / COPY
        self.assertEqual(
            sorted(path.name for path in handed_out.iterdir() if path.suffix != ".json"),
            ["README.md", "direct_light.glsl", "path_trace.glsl"],
        )
        self.assertIn("TODO", (handed_out / "direct_light.glsl").read_text(encoding="utf-8"))

    def test_the_tests_of_estimators_take_it_up(self):
        self.rename()
        self.run_tests(
            "shaders", f"*LightPoints*/chapter_{COPY}:*FeatureCode.OfABareScene*/chapter_{COPY}:CosineSampling.Weights*"
        )

    def test_brings_a_technique_and_a_material_of_its_own(self):
        program = self.build()
        self.bring_technique_and_material()
        images = []
        for chapter in (program, BINARIES / "02_cosine_sampling"):
            self.render("furnace", "--width=16", "--height=16", "--samples=4", "--output=a.exr", program=chapter)
            images.append(Exr(self.folder / "a.exr").mean())
        for own, expected in zip(*images):
            self.assertAlmostEqual(own / expected, 1, delta=1e-5)
        self.run_tests("shaders", f"*FeatureCode.OfABareScene*/chapter_{COPY}:CosineSampling.Weights*")
        difference = self.run_in_tree("./lab", "diff", 20)
        for line in ("+ vec3 sample_concentrically(vec2 u) {", "+ vec3 get_own_brdf(ShadingData s, vec3 in_direction) {"):
            self.assertIn(line, difference)
        self.assertIn("Where do the two pictures differ", self.run_in_tree(sys.executable, "-B", "tools", "bug", 20))
        self.run_in_tree(sys.executable, "-B", "tools", "handout", 20, self.folder / "handout")
        self.assertIn("TODO", (self.folder / "handout/chapters" / COPY / "lambertian.glsl").read_text(encoding="utf-8"))


class AddedChapter_all(Tree, ProgramTest):
    def test_is_graded_as_the_chapter_that_it_is_a_copy_of(self):
        technique = self.chapter / "direct_light.glsl"
        self.assertEqual(self.check(), ("correct", ""))
        technique.write_text(technique.read_text(encoding="utf-8").replace("* cos_light", "", 1), encoding="utf-8")
        self.assertEqual(self.check()[0], "biased")

    def test_all_tests_of_estimators_pass(self):
        """Those of a default run: others would repeat what they prove of the original."""
        self.rename()
        for kind in ("shaders", "convergence"):
            self.run_tests(kind, f"*chapter_{COPY}*-*_all*")

    def test_all_tests_of_estimators_pass_with_its_own_technique_and_material(self):
        self.bring_technique_and_material()
        for kind in ("shaders", "convergence"):
            self.run_tests(kind, f"*chapter_{COPY}*-*IntegratesToWhat*")

    def test_the_book_has_its_page(self):
        if not shutil.which("mkdocs"):
            self.skipTest("needs MkDocs, which ./lab book installs")
        self.rename()  # a copy has no page
        binaries = self.tree / "build/bin"
        binaries.mkdir(parents=True)
        shutil.copy(BINARIES / "dump_arrays", binaries)
        self.run_in_tree(sys.executable, "-B", "tools", "book", "--output", self.folder / "book", LAB_BINARIES=str(binaries))
        self.assertTrue((self.folder / "book/chapters" / COPY / "index.html").is_file())
