"""Writes a student's tree of chapters 1 to N into the folder DIR: the lines that "exercise" in the chapter.json of chapter N names are a TODO.

It has neither later chapters nor the tests, which name solutions, nor the history. --verify proves for all chapters that
the tree configures, and that its chapter fails ./lab check before the solution is filled in and passes with it.
"""
import json
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

from book.code_blocks import take_out
from check.expected import known_mistakes
from course.pages import clean_pages
from package.make import pack
from project import (
    BINARIES,
    CHAPTERS,
    KNOWLEDGE,
    ROOT,
    Parser,
    UserError,
    description,
    number,
    run_to_end,
    show_progress,
    text_of,
    write_json,
)

HERE = Path(__file__).parent
FOLDERS = ["assets", "common", "docs", "shaders", "tools"]
FILES = [".clang-format", "CMakeLists.txt", "CMakePresets.json", "Containerfile", "LICENSE", "lab"]
# For teachers only: these contain or name solutions, or belong to the whole course.
TEACHERS = [
    "docs/teaching.md",
    "docs/debugging.md",
    "docs/extending.md",
    "docs/numerics.md",
    "docs/measuring.md",
    "docs/bugs*",
    "docs/pictures/bug*",
    "docs/grading",
    "chapters/*/mistakes.json",
    "chapters/*/solutions",
    "tools/course",
    "tools/docs",
    "tools/package",
]
EXPECTED = {"correct": 0, "biased": 1}  # exit codes of ./lab check


def few(chapter):
    """Options of a check: enough runs to tell a TODO from its solution."""
    return ["--runs", "8"] + ([] if description(CHAPTERS[chapter]).get("low_discrepancy") else ["--samples", "4"])


def exercise_of(chapter):
    return description(CHAPTERS[chapter]).get("exercise")


def write_handout(chapter, folder):
    """Writes the student's tree to `folder`, which must not exist."""
    kept = [name for n, name in CHAPTERS.items() if n <= chapter]
    ignore = shutil.ignore_patterns("__pycache__")
    for name in [*FOLDERS, *(f"chapters/{name}" for name in kept)]:
        shutil.copytree(ROOT / name, folder / name, ignore=ignore)
    for name in FILES:
        shutil.copy(ROOT / name, folder / name)
    later = [path for path in (folder / "assets/expected").iterdir() if path.stem not in kept]
    for path in [*later, *(path for pattern in TEACHERS for path in folder.glob(pattern))]:
        shutil.rmtree(path) if path.is_dir() else path.unlink()
    for name in kept:  # the names of mistakes give them away
        numbered = {str(i): seen for i, seen in enumerate(known_mistakes(int(name[:2])).values(), 1)}
        write_json(folder / KNOWLEDGE.relative_to(ROOT) / f"{name}.json", numbered)
        told = {key: value for key, value in description(name).items() if key not in ("exercise", "tests")}
        write_json(folder / "chapters" / name / "chapter.json", told, width=132)
    exercise = exercise_of(chapter)
    shader = folder / "chapters" / CHAPTERS[chapter] / exercise["file"]
    text, solution = take_out(text_of(shader), exercise)
    shader.write_text(text, encoding="utf-8")
    readme = (HERE / "readme.md").read_text(encoding="utf-8")
    for name, value in (
        ("NUMBER", str(chapter)),
        ("FOLDER", CHAPTERS[chapter]),
        ("SHADER", shader.relative_to(folder).as_posix()),
    ):
        readme = readme.replace(name, value)
    (folder / "README.md").write_text(readme, encoding="utf-8")
    clean_pages(folder, solution)


def write_pages(chapter, folder):
    """Writes the book of a student's tree."""
    with tempfile.TemporaryDirectory() as temporary:
        tree = Path(temporary) / "lab"
        write_handout(chapter, tree)
        run_to_end(
            [sys.executable, "-B", tree / "tools", "book", "--output", folder.resolve()],
            f"chapter {chapter}: its pages",
            env=os.environ | {"LAB_BINARIES": str(BINARIES.resolve())},
        )


def verify(chapter, folder):
    """Verifies what the help says, for one chapter. The programs are those of this tree: only shaders differ."""
    tree = folder / f"handout_{chapter}"
    write_handout(chapter, tree)
    missing = [name for name in CHAPTERS.values() if name > CHAPTERS[chapter] and (tree / "chapters" / name).exists()]
    if missing or (tree / "tests").exists():
        raise UserError(f"chapter {chapter}: the handout has {missing or 'tests'}")
    run_to_end(["cmake", "-S", tree, "-B", tree / "build", "-G", "Ninja"], f"chapter {chapter}: CMake")
    environment = os.environ | {"LAB_BINARIES": str(BINARIES.resolve())}
    check = [sys.executable, "-B", tree / "tools", "check", chapter, *few(chapter)]
    result = json.loads(
        run_to_end([*check, "--json"], f"chapter {chapter}: check of the TODO", EXPECTED["biased"], env=environment)
    )
    passed = [scene["scene"] for scene in result["scenes"] if scene["verdict"] != "biased"]
    if passed != description(CHAPTERS[chapter])["check"].get("passed_by_placeholder", []):
        raise UserError(f"chapter {chapter}: the scenes that the TODO passes are {passed}: write them into chapter.json")
    solution = ROOT / "chapters" / CHAPTERS[chapter] / exercise_of(chapter)["file"]
    run_to_end([*check, solution], f"chapter {chapter}: check of the solution", EXPECTED["correct"], env=environment)


def main():
    parser = Parser("./lab handout", __doc__)
    parser.add_argument("chapter", type=number(int, 1), nargs="?", metavar="N", help="the last chapter")
    parser.add_argument("folder", type=Path, nargs="?", metavar="DIR", help="to be made; must not exist")
    parser.add_argument(
        "--pages",
        action="store_true",
        help="write only the tree's pages, in which its chapters render: a site that works from a disk",
    )
    parser.add_argument("--windows", action="store_true", help="write DIR.zip, with programs to unpack and run on Windows")
    parser.add_argument("--verify", action="store_true", help="write nothing, but try every chapter's handout, or that of N")
    options = parser.parse_intermixed_args()
    known = [chapter for chapter in CHAPTERS if exercise_of(chapter)]
    if options.chapter not in [*known, *([None] if options.verify else [])]:
        parser.error(f"N must be a chapter with an exercise in its chapter.json: {', '.join(map(str, known))}")
    if options.verify == bool(options.folder):
        parser.error("give N and DIR, or --verify")
    if not options.verify:
        result = options.folder.with_name(options.folder.name + ".zip") if options.windows else options.folder
        if result.exists():
            raise UserError(f"{result} exists already: choose another name")
        if options.pages:
            write_pages(options.chapter, options.folder)
            print(
                f"{options.folder / 'index.html'}: what students download there is what ./lab check {options.chapter} FILE grades"
            )
            return
        if options.windows:
            with tempfile.TemporaryDirectory() as folder:
                write_handout(options.chapter, Path(folder) / "lab")
                pack("windows", result, Path(folder) / "lab")
            return
        write_handout(options.chapter, options.folder)
        print(
            f"{options.folder}: chapters 1 to {options.chapter}; cd there, ./lab run {options.chapter} and ./lab check {options.chapter}"
        )
        return
    chapters, started = [options.chapter] if options.chapter else known, time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for done, chapter in enumerate(chapters, 1):
            verify(chapter, Path(folder))
            show_progress(f"chapter {chapter}: fails before, passes with the solution", done, len(chapters), started)
