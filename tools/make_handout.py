#!/usr/bin/env python3
"""Writes a student's tree of chapters 1 to N into the folder DIR: what tools/exercises.json lists of chapter N is a TODO.

It has neither later chapters nor the tests, which name solutions, nor the history. --verify proves for all chapters that
the tree configures, and that its chapter fails ./lab check before the solution is filled in and passes with it.
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from command_line import Parser, at_least
from progress import show_progress

ROOT = Path(__file__).resolve().parents[1]
BINARIES = Path(os.environ.get("LAB_BINARIES", ROOT / "build/bin"))
CHAPTERS = {int(path.name[:2]): path.name for path in sorted((ROOT / "chapters").glob("[0-9]*"))}
FOLDERS = ["assets", "common", "docs", "shaders", "tools"]
FILES = [".clang-format", "CMakeLists.txt", "CMakePresets.json", "Containerfile", "LICENSE", "lab"]
# What only teachers need: it names solutions or makes what belongs to the whole course.
TEACHERS = ["docs/teaching.md", "docs/numerics.md", "docs/slides.md", "docs/records/check/confusion.json",
            "tools/exercises.json", "tools/make_handout.py", "tools/handout_readme.md", "tools/false_alarms.py",
            "tools/fresh_machine", "tools/learn_mistakes.py", "tools/planting.py", "tools/confusion_table.py",
            "tools/cost_tables.py", "tools/peer_table.py", "tools/make_benchmark.py", "tools/make_figures.py",
            "tools/figure_plots.py", "tools/make_numerics.py", "tools/make_results.py"]
EXPECTED = {"correct": 0, "biased": 1}  # exit codes of ./lab check
FEW = ["--runs", "8", "--samples", "4"]  # enough to tell a TODO from its solution


class StaleExercise(Exception):
    pass


def exercises(number):
    return [e for e in json.loads((ROOT / "tools/exercises.json").read_text(encoding="utf-8")) if e["chapter"] == number]


def find_once(text, piece, exercise):
    if text.count(piece) != 1:
        raise StaleExercise(f"stale: {exercise['file']} has {text.count(piece)} places with {piece!r}")
    return text.index(piece)


def take_out(text, exercise):
    """The shader with the placeholder in place of the solution, and the solution."""
    begin = find_once(text, exercise["first"], exercise)
    end = find_once(text, exercise["last"], exercise) + len(exercise["last"])
    if begin >= end:
        raise StaleExercise(f"stale: {exercise['file']}: {exercise['last']!r} is before {exercise['first']!r}")
    indent = " " * (begin - text.rindex("\n", 0, begin) - 1)
    return text[:begin] + f"\n{indent}".join(exercise["placeholder"]) + text[end:], text[begin:end]


def included(chapters):
    """Files of shaders/ that the shaders of chapters include."""
    return {name for chapter in chapters for shader in (ROOT / "chapters" / chapter).glob("*.glsl")
            for name in re.findall(r'#include "(.*)"', shader.read_text(encoding="utf-8"))}


def write_handout(number, folder):
    """The student's tree in `folder`, which must not exist."""
    kept = [name for n, name in CHAPTERS.items() if n <= number]
    later = [name for n, name in CHAPTERS.items() if n > number]
    ignore = shutil.ignore_patterns("__pycache__")
    for name in [*FOLDERS, *(f"chapters/{chapter}" for chapter in kept)]:
        shutil.copytree(ROOT / name, folder / name, ignore=ignore)
    for name in FILES:
        shutil.copy(ROOT / name, folder / name)
    # Shared shaders that only later chapters include hold what this one asks for.
    for name in [*TEACHERS, *(f"shaders/{name}" for name in included(later) - included(kept))]:
        (folder / name).unlink()
    # Splitting at every hit repeats the estimators of the chapters that have it.
    if any("split_every_hit" in json.loads((ROOT / "chapters" / name / "chapter.json").read_text(encoding="utf-8"))
           for n, name in CHAPTERS.items() if n >= number):
        (folder / "shaders/path_trace_every_hit.glsl").unlink()
    (folder / "docs/records/check").rmdir()
    for exercise in exercises(number):
        shader = folder / exercise["file"]
        text, solution = take_out(shader.read_text(encoding="utf-8"), exercise)
        shader.write_text(text, encoding="utf-8")
        hide(solution, folder)
    readme = (ROOT / "tools/handout_readme.md").read_text(encoding="utf-8")
    for name, value in (("NUMBER", str(number)), ("FOLDER", CHAPTERS[number]), ("SHADER", exercises(number)[0]["file"])):
        readme = readme.replace(name, value)
    (folder / "README.md").write_text(readme, encoding="utf-8")
    leave_out_tests(folder)
    unlink_what_is_missing(folder)


def hide(solution, folder):
    """Takes quotations of the solution out of the pages."""
    for page in folder.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        page.write_text(re.sub(r"\[`([^`]+)`\](?=\([^)]*\.glsl\))", lambda quote: "[TODO]" if quote[1] in solution and
                               not re.fullmatch(r"\w+(\(\))?", quote[1]) else quote[0], text), encoding="utf-8")


def leave_out_tests(folder):
    """An exercise is done when the check says so."""
    for page in folder.glob("chapters/*/README.md"):
        text = page.read_text(encoding="utf-8")
        text = re.sub(r"Done\s+when all tests named [^,]* pass,\s+and\s+(?=`\./lab check)", "Done when ", text)
        text = re.sub(r"\s+Tests are run by `\./lab test -R` and\s+their\s+name\.", "", text)
        page.write_text(text, encoding="utf-8")


def unlink_what_is_missing(folder):
    """Links to files that stay out become plain text."""
    for page in folder.rglob("*.md"):
        def shown(link):
            target = link[2].split("#")[0]
            return link[0] if "://" in target or (page.parent / target).exists() else link[1]

        page.write_text(re.sub(r"(?<!!)\[([^\[\]]+)\]\(([^()\s]+)\)", shown, page.read_text(encoding="utf-8")), encoding="utf-8")


def run(command, expected, what, **options):
    result = subprocess.run(list(map(str, command)), capture_output=True, text=True, **options)
    if result.returncode != expected:
        sys.exit(f"error: {what}: exit code {result.returncode} instead of {expected}:\n{result.stdout}{result.stderr}")


def verify(number, folder):
    """Proves what the help says of one chapter. The programs are those of this tree: only shaders differ."""
    tree = folder / f"handout_{number}"
    write_handout(number, tree)
    missing = [name for name in CHAPTERS.values() if name > CHAPTERS[number] and (tree / "chapters" / name).exists()]
    if missing or (tree / "tests").exists():
        sys.exit(f"error: chapter {number}: the handout has {missing or 'tests'}")
    run(["cmake", "-S", tree, "-B", tree / "build", "-G", "Ninja"], 0, f"chapter {number}: CMake")
    environment = os.environ | {"LAB_BINARIES": str(BINARIES.resolve())}
    check = [sys.executable, "-B", tree / "tools/check.py", number, *FEW]
    run(check, EXPECTED["biased"], f"chapter {number}: check of the TODO", env=environment)
    solution = ROOT / "chapters" / CHAPTERS[number] / "path_trace.glsl"
    run([*check, solution], EXPECTED["correct"], f"chapter {number}: check of the solution", env=environment)


def main():
    parser = Parser(prog="./lab handout", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("chapter", type=at_least(1, int), nargs="?", metavar="N", help="the last chapter")
    parser.add_argument("folder", type=Path, nargs="?", metavar="DIR", help="to be made; must not exist")
    parser.add_argument("--verify", action="store_true", help="write nothing, but try every chapter's handout, or that of N")
    options = parser.parse_intermixed_args()
    known = [number for number in CHAPTERS if exercises(number)]
    if options.chapter not in [*known, *([None] if options.verify else [])]:
        parser.error(f"N must be a chapter with an exercise in tools/exercises.json: {', '.join(map(str, known))}")
    if options.verify == bool(options.folder):
        parser.error("give N and DIR, or --verify")
    try:
        if options.verify:
            numbers, started = [options.chapter] if options.chapter else known, time.monotonic()
            with tempfile.TemporaryDirectory() as folder:
                for done, number in enumerate(numbers, 1):
                    verify(number, Path(folder))
                    show_progress(f"chapter {number}: fails before, passes with the solution", done, len(numbers), started)
            return
        if options.folder.exists():
            sys.exit(f"error: {options.folder} exists already: choose another folder")
        write_handout(options.chapter, options.folder)
        print(f"{options.folder}: chapters 1 to {options.chapter}; cd there, ./lab run {options.chapter} and ./lab check {options.chapter}")
    except (StaleExercise, OSError) as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
