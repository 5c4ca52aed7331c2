"""The pages name files, pieces of code, tests and commands: all of them must exist, and the commands must run.

What is checked: a link to a source file whose text is `code` quotes that file; a heading after # is one of the page;
`Suite.Test` is a test; a line or a `piece` that starts with ./lab is a command.
"""

import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from program import BINARIES, TOOLS, UNOPTIMISED  # first: it finds the tools
from program import PROJECT as ROOT
import cited_tests
from course.handout import take_out
from lesson import sample
from project import description

PAGES = [ROOT / "README.md", *sorted(ROOT.glob("docs/**/*.md")), *sorted(ROOT.glob("chapters/**/README.md"))]
CHAPTERS = {int(path.name[:2]): path.name for path in ROOT.glob("chapters/[0-9]*")}
COURSE = [name for name in CHAPTERS.values() if "exercise" in description(name)]
SECTIONS = [
    "From the formula to the code",
    "The decisive lines",
    "What it gains, and where it does not",
    "What can go wrong",
    "How we know",
    "Exercises",
    "Summary",
]  # of each chapter's page, in this order
MOST_LINES = 233  # of a chapter, which is read in one sitting
SOURCE_SUFFIXES = {".h", ".cpp", ".glsl", ".comp", ".rgen", ".rchit", ".rmiss", ".py"}
SIZE = ("--width", "--height")
SMALL_RENDER = {"--width": "8", "--height": "8", "--samples": "1", "--backend": "compute", "--output": "picture.png"}


def text_of(path):
    return path.read_text(encoding="utf-8")


def sources(folders, suffixes=SOURCE_SUFFIXES):
    """The text of all code, to look up identifiers on the pages."""
    files = [path for folder in folders for path in (ROOT / folder).rglob("*") if path.suffix in suffixes]
    return "\n".join(map(text_of, files))


def anchors(page):
    """Anchors of all headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", text_of(page), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def defines(text, function):
    """Whether a source has a function's definition or declaration, and not only calls and comments."""
    start = r"^ *(?:def|(?!return|else|new|throw|case)\w[\w:<>,*&\[\] ]*[\w>*&\]])"
    return re.search(rf"{start} +[*&]?(?:\w+::)*{function}\(", text, re.MULTILINE) is not None


def has_piece(text, piece):
    """Whether a source contains a quotation: names and calls() anywhere, longer pieces in exactly one place."""
    if re.fullmatch(r"\w+", piece):
        return re.search(rf"\b{piece}\b", text) is not None
    if re.fullmatch(r"\w+\(\)", piece):
        return re.search(rf"\b{piece[:-2]}\(", text) is not None
    return text.count(piece) == 1


def commands(page):
    """The words of all commands on a page, without `./lab` and comments."""
    text = text_of(page)
    lines = re.findall(r"`\./lab ([^`\n]+)`", text) + re.findall(r"^ {4,}\./lab (.+)$", text, re.MULTILINE)
    return [tuple(shlex.split(line, comments=True)) for line in lines]


def program_of(number, page):
    """A chapter's program. The pages call a student's copy 20: then it is the chapter whose folder holds the page, or else
    any."""
    folder = page.relative_to(ROOT).parts[1] if page.is_relative_to(ROOT / "chapters") else COURSE[0]
    return BINARIES / CHAPTERS.get(int(number), folder)


def small_render(words, page):
    """Program and arguments of `./lab run ...`, reduced to take almost no time."""
    number, *arguments = words
    # A reference has its own size.
    small = {name: value for name, value in SMALL_RENDER.items() if name not in SIZE or "--reference" not in arguments}
    if "--sanitize" in arguments:
        small.pop("--backend")  # it has its own
    kept, words = [], iter(arguments)
    for word in words:
        if word in small:
            next(words)
        else:
            kept.append(str(ROOT / "assets/meshes/torus.obj") if word == "my_model.obj" else word)
    return [program_of(number, page), *kept, *(word for option in small.items() for word in option)]


class DocumentationTest(unittest.TestCase):
    def test_links_lead_to_files_and_headings(self):
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)\)", text_of(page)):
                if "://" in target or re.match(r"(\.\./)+(actions|releases)\b", target):  # of the repository's site
                    continue
                name, _, anchor = target.partition("#")
                path = page.parent / name if name else page
                if "notebook/" in name and not (ROOT / "notebook").exists():  # as in a copy of the course alone
                    continue
                self.assertTrue(path.exists(), f"{page.relative_to(ROOT)}: no file {name}")
                if anchor:
                    self.assertIn(anchor, anchors(path), f"{page.relative_to(ROOT)}: {target}")

    def test_quoted_code_is_in_the_file(self):
        for page in PAGES:
            for piece, target in re.findall(r"\[`([^`]+)`\]\(([^)#\s]+)\)", text_of(page)):
                path = page.parent / target
                if (path.suffix in SOURCE_SUFFIXES or path.name == "lab") and "://" not in target:
                    quoted = has_piece(text_of(path), piece.replace("\\|", "|"))
                    self.assertTrue(quoted, f"{page.relative_to(ROOT)}: {target} has no, or more than one, `{piece}`")

    def test_links_from_functions_lead_to_their_definitions(self):
        text = sources(("common", "shaders", "chapters", "tools", "tests"))
        for page in PAGES:
            for name, target in re.findall(r"\[`(\w+)\(\)`\]\(([^)#\s]+)\)", text_of(page)):
                if defines(text, name):  # or else the file shows a call of one that is not ours
                    self.assertTrue(
                        defines(text_of(page.parent / target), name), f"{page.relative_to(ROOT)}: {target} only calls {name}()"
                    )

    def test_code_that_is_named_exists(self):
        text = (
            sources(("common", "shaders", "chapters", "tools", "tests"))
            + text_of(ROOT / "lab")
            + text_of(ROOT / "tests/fresh_machine")
        )
        text += "\n".join(path.stem for path in (ROOT / "assets").rglob("*"))  # scenes and references
        for page in PAGES:
            for code in re.findall(r"`([^`\n]+)`", text_of(page)):
                if "notebook" in code:  # which may be missing
                    continue
                # Names with an underscore or a scope, and calls, count as identifiers of ours or Vulkan's.
                for name in re.findall(r"\b[A-Za-z]\w*(?:::\w+)+|\b[a-z]\w*_\w+\b|\b\w+(?=\()", code):
                    last = name.split("::")[-1]
                    if last.startswith("VK_") or last in KNOWN_ELSEWHERE:
                        continue
                    self.assertTrue(last in text, f"{page.name}: `{code}` names {last}, which no source has")

    def test_tests_that_are_named_exist(self):
        known = {(suite, test.removesuffix("_all")) for suite, test in cited_tests.written_tests()}
        for page in PAGES:
            for suite, test in re.findall(r"`([A-Z]\w+)\.([A-Z]\w+)`", text_of(page)):
                self.assertTrue((suite, test) in known, f"{page.relative_to(ROOT)}: no test {suite}.{test}")

    def test_chapter_pages_are_complete(self):
        suites = {suite for suite, _ in cited_tests.written_tests()}
        for chapter in COURSE:  # chapters added by others may have different pages
            text = text_of(ROOT / "chapters" / chapter / "README.md")
            self.assertLessEqual(len(text.splitlines()), MOST_LINES, f"{chapter}/README.md")
            for part in (
                "\n    ./lab run ",
                "\n![",
                "\n<!-- measured: ",
                "\n<!-- code: ",
                "Symbols: [table](../../docs/slides.md#symbols)",
            ):
                self.assertTrue(part in text, f"{chapter}/README.md has no {part.strip()!r}, which pages with an exercise have")
            self.assertEqual(
                [heading for heading in re.findall(r"^## (.*)$", text, re.MULTILINE) if heading in SECTIONS], SECTIONS, chapter
            )
            kinds = re.findall(r"^\d+\. \*([\w ]+)\.\*", text, re.MULTILINE)
            self.assertGreaterEqual(len(kinds), 5, chapter)
            self.assertLessEqual({"Fill in", "Derive", "Measure", "Find the bug", "Explore", "Challenge"}, set(kinds), chapter)
            self.assertEqual((kinds[0], kinds[-1]), ("Fill in", "Challenge"), chapter)
            named = cited_tests.tests_of_exercise(chapter)
            self.assertTrue(named and set(named) <= suites, f"{chapter}: tests {named}")

    def test_solutions_of_the_first_exercise_are_folded(self):
        for chapter in COURSE:
            folder = ROOT / "chapters" / chapter
            exercise = description(chapter)["exercise"]
            _, solution = take_out(text_of(folder / exercise["file"]), exercise)
            open_text = re.sub(r"<details>.*?</details>", "", text_of(folder / "README.md"), flags=re.DOTALL)
            shown = {
                line.strip() for block in re.findall(r"```glsl\n(.*?)```", open_text, re.DOTALL) for line in block.splitlines()
            }
            self.assertEqual({line.strip() for line in solution.splitlines() if re.search(r"\w", line)} & shown, set(), chapter)

    def test_mistakes_name_a_slide_or_a_section_of_their_page(self):
        for chapter in COURSE:
            headings = re.findall(r"^###? (.*)$", text_of(ROOT / "chapters" / chapter / "README.md"), re.MULTILINE)
            for mistake in json.loads(text_of(ROOT / "chapters" / chapter / "mistakes.json")):
                self.assertTrue(
                    "slide" in mistake or mistake.get("section", headings[0]) in headings, f"{chapter}: {mistake['name']}"
                )

    def test_every_exercise_has_a_solution(self):
        for chapter in COURSE:  # for exercise 1 it is the chapter's shader
            exercises = re.findall(r"^(\d+)\. \*([\w ]+)\.\*", text_of(ROOT / "chapters" / chapter / "README.md"), re.MULTILINE)
            solutions = re.findall(
                r"^## (\d+)\. ([\w ]+)", text_of(ROOT / "chapters" / chapter / "solutions/README.md"), re.MULTILINE
            )
            self.assertEqual(solutions, exercises[1:], chapter)
            named = re.search(
                r"[Ee]xercise 1 is [^()]*\(\.\./(\w+\.glsl)\)", text_of(ROOT / "chapters" / chapter / "solutions/README.md")
            )
            self.assertEqual(named[1], description(chapter)["exercise"]["file"], chapter)

    def test_tables_are_what_the_sources_say(self):
        subprocess.run([sys.executable, "-B", TOOLS, "tables", "--check"], check=True)
        for page in PAGES:
            self.assertNotRegex(text_of(page), r"<!-- (table|measured): .* -->\n\s*<!-- end of table -->", page)

    def test_the_page_of_scenes_has_every_key_and_keyword(self):
        page = text_of(ROOT / "docs/scenes.md")
        keys = {
            key
            for keys in re.findall(r'\{("\w+"(?:,\s*"\w+")+)\}', text_of(ROOT / "common/scene/scene_file.cpp"))
            for key in re.findall(r"\w+", keys)
        }
        keywords = set(re.findall(r'^ *\{"(\w+)"', text_of(ROOT / "common/scene/material_keywords.h"), re.MULTILINE))
        for heading, names in (("Keys of a scene file", keys), ("Keywords of a material", keywords)):
            rows = re.search(rf"^## {heading}$.*?^(\|.*?)\n(?:\n|<)", page, re.MULTILINE | re.DOTALL)[1]
            first = {name for row in rows.split("\n")[2:] for name in re.findall(r"`(\w+)`", row.split("|")[1])}
            self.assertGreater(len(names), 10)
            nested = names & {"axis", "degrees", "position", "target"}  # told beside their objects
            self.assertEqual(first | nested & set(re.findall(r"`(\w+)`", rows)), names, heading)
        for key, default in re.findall(
            r"uint32_t (\w+) = (\d+);",
            re.search(r"struct RenderDefaults .*?};", text_of(ROOT / "common/scene/scene.h"), re.DOTALL)[0],
        ):
            self.assertTrue(re.search(rf"(?m)^\| .*`{key}`.* {default} \|$", page), f"the default of {key} is {default}")

    def test_every_numerical_trap_has_tests_that_exist(self):
        cases = cited_tests.load_cases()
        listed = {case["research"] for case in cases}
        self.assertEqual([trap for trap in NUMERICAL_TRAPS if trap not in listed], [])
        for case in cases:
            self.assertEqual(bool(case["tests"]), case["research"] not in TRAPS_THAT_CANNOT_OCCUR, case["case"])
        self.assertEqual(cited_tests.missing_tests(), [])


class DocumentedCommandsTest(unittest.TestCase):
    def test_commands_exist(self):
        lab, options = text_of(ROOT / "lab"), text_of(ROOT / "lab") + sources(["tools", "tests"], {".py", ".cpp"})
        for page in PAGES:
            for name, *arguments in commands(page):
                self.assertTrue(f"\ncommand_{name}()" in lab, f"{page.relative_to(ROOT)}: ./lab {name}")
                if name == "sample" and arguments:
                    self.assertIn(arguments[0], sample.PLAYGROUNDS)
                for argument in arguments if name not in ("run", "notebook") else []:
                    if argument.startswith("--"):
                        self.assertTrue(argument in options, f"{page.relative_to(ROOT)}: ./lab {name} {argument}")


class DocumentedRendersTest(unittest.TestCase):
    pages, fewest = PAGES[:1], 2  # the README

    def test_run(self):
        renders = {words[1:]: page for page in self.pages for words in commands(page) if words[0] == "run"}
        complete = [words for words in renders if words and words[0].isdigit() and not {"...", "--help"} & set(words)]
        self.assertGreaterEqual(len(complete), self.fewest)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "assets").symlink_to(ROOT / "assets")
            for words in complete:
                result = subprocess.run(
                    small_render(words, renders[words]),
                    cwd=folder,
                    capture_output=True,
                    text=True,
                    timeout=300,
                    env=os.environ | UNOPTIMISED,
                )
                command = f"{renders[words].relative_to(ROOT)}: ./lab run {' '.join(words)}"
                self.assertEqual(result.returncode, 0, f"{command}: {result.stderr}")


class EveryDocumentedRender_all(DocumentedRendersTest):
    pages, fewest = PAGES, 20


# Section 3 of our survey of renderers; we do not sample by solid angle (3.7), so that trap cannot occur.
NUMERICAL_TRAPS = [f"3.{number}" for number in range(1, 25)]
TRAPS_THAT_CANNOT_OCCUR = {"3.7"}

# Quoted from the slides, the blog and GLSL.
KNOWN_ELSEWHERE = {"pixel_index", "frame_index", "my_model"}
