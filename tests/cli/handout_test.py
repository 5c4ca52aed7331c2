"""./lab handout: each chapter's tree works, fails its check until the solution is filled in, and gives nothing away."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from program import BINARIES, PROJECT, TOOLS, ProgramTest, copy_project

CHAPTERS = sorted(path.name for path in (PROJECT / "chapters").glob("[0-9]*"))
NUMBERS = {int(name[:2]): name for name in CHAPTERS}
EXERCISES = {
    name: json.loads((PROJECT / "chapters" / name / "chapter.json").read_text(encoding="utf-8"))["exercise"] for name in CHAPTERS
}
MISTAKES = {
    mistake["name"]
    for name in CHAPTERS
    for mistake in json.loads((PROJECT / "chapters" / name / "mistakes.json").read_text(encoding="utf-8"))
}
# What other pages could reveal of chapter 3's solution, and what is for teachers only.
QUOTATION = """
<!-- code: chapters/03_next_event_estimation/path_trace.glsl | V: a shadow ray | * y.emission; -->
```glsl
// V: a shadow ray that ends just short of the light.
if (is_occluded(get_ray_to_point(s, y.position_in_front), 1.0)) return vec3(0.0);
float geometry = dot(s.normal, omega) * cos_light / (distance * distance);
```
<!-- end of code -->

The term is `cos_light / (distance * distance)`. See [the model answer](solutions/03.md). It is right: run `./lab
test`.
Another is [`float later = 1.0;`](../07_multiple_importance_sampling/path_trace.glsl).

<!-- code: chapters/07_multiple_importance_sampling/path_trace.glsl | p_b | p_b -->
```glsl
float later = 1.0;
```
<!-- end of code -->
"""
TEACHERS = ["mistakes.json", "solutions"]  # in a chapter's folder
FOR_TEACHERS = [
    "chapters/03_next_event_estimation/solutions/03.md",
    "docs/bugs.md",
    "docs/teaching.md",
    "tools/course/answers.py",
    "tools/docs/answers.json",
]


def handout(folder, *arguments, tools=TOOLS):
    command = [sys.executable, "-B", tools, "handout", *arguments]
    return subprocess.run(
        list(map(str, command)), cwd=folder, capture_output=True, text=True, env=os.environ | {"LAB_BINARIES": str(BINARIES)}
    )


class EveryHandout_all(ProgramTest):
    def test_fails_before_and_passes_with_the_solution(self):
        result = handout(self.folder, "--verify")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)


class EveryHandoutsPages_all(ProgramTest):
    def test_can_be_written(self):
        if not shutil.which("mkdocs"):
            self.skipTest("needs MkDocs, which ./lab book installs")
        for number, name in NUMBERS.items():
            with self.subTest(chapter=name):
                site = self.folder / name
                result = handout(self.folder, number, site, "--pages")
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertIn(f'data-chapter="{name}"', (site / f"chapters/{name}/index.html").read_text(encoding="utf-8"))


class HandoutTest(ProgramTest):
    @classmethod
    def setUpClass(cls):
        cls.trees = Path(cls.enterClassContext(tempfile.TemporaryDirectory()))

    def handout(self, *arguments, **options):
        return handout(self.folder, *arguments, **options)

    def tree(self, number):
        """The handout of a chapter, to be read: it is written once for all tests."""
        tree = self.trees / f"handout_{number}"
        if not tree.exists():
            result = self.handout(number, tree)
            self.assertEqual(result.returncode, 0, result.stderr)
        return tree

    def test_the_tree_has_nothing_of_later_chapters_and_no_solution(self):
        for number, name in NUMBERS.items():
            tree, exercise = self.tree(number), EXERCISES[name]
            self.assertEqual(sorted(os.listdir(tree / "chapters")), [other for other in CHAPTERS if other <= name])
            self.assertFalse((tree / "tests").exists() or (tree / ".git").exists())
            self.assertIn("TODO", (tree / "chapters" / name / exercise["file"]).read_text(encoding="utf-8"))
            self.assertEqual([path for path in tree.glob("chapters/*/*") if path.name in TEACHERS], [])
            for path in (
                path for name in ("chapters", "shaders", "tools", "docs", "notebook") for path in (tree / name).rglob("*")
            ):
                if path.suffix in (".glsl", ".md", ".py", ".json"):
                    text = path.read_text(encoding="utf-8")
                    self.assertNotIn(exercise["last"], text, path)
                    self.assertEqual([mistake for mistake in MISTAKES if f'"{mistake}"' in text], [], path)
            self.assertEqual(max(path.stem for path in (tree / "assets/expected").iterdir()), name)
            knowledge = json.loads((tree / "notebook/knowledge" / f"{name}.json").read_text(encoding="utf-8"))
            self.assertEqual(list(knowledge), [str(i) for i, _ in enumerate(knowledge, 1)])

            page = (tree / "chapters" / name / "README.md").read_text(encoding="utf-8")
            self.assertNotIn("the solution of exercise 1", page)
            self.assertEqual(page.count("<details>"), page.count("</details>"))
            pages = "".join(page.read_text(encoding="utf-8") for page in tree.rglob("*.md"))
            for later in (other for other in CHAPTERS if other > name):
                self.assertNotIn(EXERCISES[later]["last"], pages, f"{later} in the handout of {name}")

    def test_holds_the_slides_with_their_symbols_and_the_first_steps(self):
        for number in (1, 3):
            tree = self.tree(number)
            slides, steps = ((tree / "docs" / name).read_text(encoding="utf-8") for name in ("slides.md", "first_steps.md"))
            self.assertIn("\n## Symbols\n", slides)
            self.assertIn("omega", slides)
            self.assertGreater(len(list((tree / "docs/diagrams").glob("*.svg"))), 5)
            # From step 5 on, the page shows the solution of exercise 1 of chapter 1.
            self.assertEqual(re.findall(r"^## (\d)", steps, re.MULTILINE), list("1234" if number == 1 else "12345678"))
            self.assertIn("\n## Reading the check\n", steps)
            self.assertIn("`vec3 get_brdf(", (tree / "docs/shader.md").read_text(encoding="utf-8"))
            self.assertIn("](docs/shader.md)", (tree / "README.md").read_text(encoding="utf-8"))

    def copied_project(self):
        project = self.folder / "project"
        copy_project(project, "docs", ".clang-format", "CMakeLists.txt", "CMakePresets.json", "Containerfile", "LICENSE", "lab")
        return project

    def test_sources_may_have_the_encoding_of_windows(self):
        """Handouts, and the other tools that read shaders."""
        project = self.copied_project()
        with open(project / "chapters/03_next_event_estimation/direct_light.glsl", "a", encoding="cp1252") as shader:
            shader.write("// Prüfen\n")
        for words in (["handout", 3, "lab"], ["diff", 3], ["diff", "all"], ["bug", 3], ["bug", 3, 1, "--answer"]):
            code, out, err = self.run_program("-B", project / "tools", *words, program=sys.executable)
            self.assertEqual((code, err), (0, ""), words)
            self.assertTrue("// Prüfen" in out or words != ["diff", 3])
        self.assertTrue(
            (self.folder / "lab/chapters/03_next_event_estimation/direct_light.glsl")
            .read_text(encoding="utf-8")
            .endswith("// Prüfen\n")
        )

    def test_solutions_and_bugs_stay_out_also_where_pages_quote_them(self):
        project = self.copied_project()
        for name in FOR_TEACHERS:
            self.write(project / name, "planted")
        page = project / "chapters/03_next_event_estimation/README.md"
        page.write_text(page.read_text(encoding="utf-8") + QUOTATION, encoding="utf-8")
        result = self.handout(3, "lab", tools=project / "tools")
        self.assertEqual(result.returncode, 0, result.stderr)
        tree = self.folder / "lab"
        self.assertEqual([name for name in FOR_TEACHERS if (tree / name).exists()], [])
        texts = {
            path.relative_to(tree): path.read_bytes() for path in tree.rglob("*") if path.is_file() and path.parts[0] != "assets"
        }
        self.assertEqual([path for path, text in texts.items() if text == b"planted"], [])
        self.assertTrue(
            (tree / page.relative_to(project))
            .read_text(encoding="utf-8")
            .endswith(
                """
```glsl
// TODO
```

The term is TODO. See the model answer.
Another is code of chapter 7.

(code of chapter 7)
"""
            )
        )

    def test_no_link_leads_nowhere(self):
        tree = self.tree(3)
        links = [
            (page, link)
            for page in tree.rglob("*.md")
            for link in re.findall(r"\]\(([^()\s#]+)[^()\s]*\)", page.read_text(encoding="utf-8"))
            if "://" not in link
        ]
        self.assertGreater(len(links), 50)
        self.assertEqual([(page, link) for page, link in links if not (page.parent / link).exists()], [])

    def test_shaders_include_nothing_that_stays_out(self):
        tree = self.tree(3)
        shaders = [
            file
            for folder in ("shaders", "tools", "chapters")
            for file in (tree / folder).rglob("*")
            if file.suffix in (".glsl", ".comp", ".rgen", ".rchit", ".rmiss", ".h")
        ]
        includes = [
            (file, name)
            for file in shaders
            for name in re.findall(r'^#include "(.*)"', file.read_text(encoding="utf-8"), re.MULTILINE)
        ]
        self.assertGreater(len(includes), 50)
        # Supplied by the programs, or by a chapter that has a filter.
        given = {
            "path_trace.glsl",
            "camera.glsl",
            "observed.glsl",
            "observed_sample_loop.glsl",
            "filter.glsl",
            "filter_input.glsl",
        }
        self.assertEqual(
            [
                (file, name)
                for file, name in includes
                if name not in given
                and not any((folder / name).exists() for folder in (file.parent, tree / "shaders", tree / "chapters", tree))
            ],
            [],
        )

    def test_pages_speak_of_what_is_there(self):
        for page in self.tree(max(NUMBERS)).rglob("*.md"):
            self.assertNotRegex(
                page.read_text(encoding="utf-8"),
                r"lab\s+(test|figures|handout|bug)\b|all\s+tests\s+named|NUMBER|FOLDER|SHADER",
                page,
            )

    def test_bugs_to_find_still_ask(self):
        """Sentences with ./lab bug are cut: what is asked stands in others."""
        for number, name in NUMBERS.items():
            page = (self.tree(number) / "chapters" / name / "README.md").read_text(encoding="utf-8")
            bugs = re.findall(r"^\d+\. (\*Find the bug\.\*.*?)\s*(?=^\d+\. |^## )", page, re.DOTALL | re.MULTILINE)
            self.assertGreater(len(bugs), 0, name)
            for bug in bugs:
                with self.subTest(chapter=name):
                    self.assertTrue(bug.endswith("?"), bug)

    def test_its_pages_give_nothing_away(self):
        if not shutil.which("mkdocs"):
            self.skipTest("needs MkDocs, which ./lab book installs")
        for number, folder in ((1, "first"), (3, "pages")):
            result = self.handout(number, folder, "--pages")
            self.assertEqual(result.returncode, 0, result.stderr)
        site = self.folder / "pages"
        secret = EXERCISES[CHAPTERS[2]]["last"]
        texts = {path: path.read_text(encoding="utf-8") for pattern in ("*.html", "*.js") for path in site.rglob(pattern)}
        self.assertEqual([path for path, text in texts.items() if secret in text or json.dumps(secret)[1:-1] in text], [])
        sources = texts[site / "live/sources.js"]
        self.assertIn("// TODO", sources)
        self.assertNotIn("chapters/04_", sources)
        self.assertNotIn('"find"', sources)
        self.assertFalse((site / f"chapters/{CHAPTERS[3]}").exists())
        self.assertIn('data-chapter="03_', texts[site / f"chapters/{CHAPTERS[2]}/index.html"])

    def test_commands_that_need_the_tests_say_so(self):
        tree = self.tree(1)
        help_text = subprocess.run(["./lab"], cwd=tree, capture_output=True, text=True, timeout=300).stdout
        self.assertIn("  check N", help_text)
        self.assertNotIn("  handout", help_text)
        result = subprocess.run(["./lab", "test"], cwd=tree, capture_output=True, text=True, timeout=300)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"\Alab: this student's tree has no 'test'[^\n]*\n\Z")

    def test_what_cannot_be_written_is_refused(self):
        for arguments in ((), (1,), (99, "lab"), (1, "."), (1, "lab", "--verify")):
            result = self.handout(*arguments)
            self.assertEqual(result.returncode, 1)
            self.assertRegex(result.stderr, r"\Aerror: [^\n]{12,}\n\Z")
