"""Makes a mistake of cpp_mistakes.json in a copy of the C++ sources, builds the test program and expects its test to be red.

    ./lab notebook mistakes NAME...
    ./lab notebook mistakes --all

The copy stays in build/mistakes: the next mistake rebuilds only what it changes. Exits with 0 if all tests were red because an
expectation failed. A mistake that does not compile, a program that crashes and text that is no longer there are errors.
"""

import filecmp
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import test_report
from course.mistakes import Stale, plant
from project import ROOT

TREE = ROOT / "build" / "mistakes"
NOT_COPIED = {".git", ".cache", "assets", "docs", "notebook", "output"}


def load():
    mistakes = json.loads((Path(__file__).parent / "cpp_mistakes.json").read_text(encoding="utf-8"))
    return {mistake["name"]: mistake for mistake in mistakes}


def copy_sources():
    """Brings the copy up to date without touching unchanged files, so that they are not rebuilt."""
    TREE.mkdir(parents=True, exist_ok=True)
    for folder in ("common", "tests", "shaders", "chapters"):
        for copy in (TREE / folder).rglob("*"):
            if copy.is_file() and not (ROOT / copy.relative_to(TREE)).exists():
                copy.unlink()
    for source in ROOT.iterdir():
        if source.name in NOT_COPIED or source.name.startswith("build"):
            continue
        for file in source.rglob("*") if source.is_dir() else [source]:
            copy = TREE / file.relative_to(ROOT)
            if file.is_file() and not (copy.exists() and filecmp.cmp(file, copy, shallow=False)):
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, copy)
                shutil.copymode(file, copy)
    if not (TREE / "assets").exists():
        (TREE / "assets").symlink_to(ROOT / "assets")
    if not (TREE / "build" / "build.ninja").exists():
        # Compiling takes longer than the tests, which are built with their own -O1.
        command = ["cmake", "--preset", "release", "-DCMAKE_CXX_FLAGS_RELEASE=-O0"]
        subprocess.run(command, cwd=TREE, check=True, stdout=subprocess.DEVNULL)


def build(target):
    """Returns the compiler's output if the program does not build."""
    command = ["cmake", "--build", TREE / "build", "--target", target]
    result = subprocess.run(command, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return result.stdout[-3000:] if result.returncode else None


def run(program, test):
    """Returns the messages of all failures of a test."""
    report = TREE / "report.json"
    report.unlink(missing_ok=True)
    display = [TREE / "tests/support/with_display.sh"] if program == "viewer" else []
    command = [*display, TREE / "build/bin" / f"{program}_tests", f"--gtest_output=json:{report}", f"--gtest_filter={test}"]
    environment = {**os.environ, "GALLIVM_PERF": "nopt"}
    result = subprocess.run(command, check=False, cwd=TREE, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if not report.exists():
        sys.exit(f"{program}_tests ended with {result.returncode} before its test did:\n{result.stdout.decode()[-2000:]}")
    tests, _ = test_report.read(report)
    if not tests:
        sys.exit(f"there is no test {program}.{test}")
    return [failure for test in tests for failure in test.failures]


def find_source(mistake):
    """The only file of common/ that contains the text, wherever it has moved, and its contents."""
    files = {file: file.read_text(encoding="utf-8") for file in (TREE / "common").rglob("*") if file.suffix in (".cpp", ".h")}
    found = [item for item in files.items() if mistake["find"] in item[1]]
    if len(found) != 1:
        raise Stale(f"stale: {mistake['name']}: {len(found)} files with {mistake['find']!r}")
    return found[0]


def failures_with(mistake):
    """The failures of a mistake's test while the copy contains the mistake."""
    source, text = find_source(mistake)
    program, test = mistake["test"].split(".", 1)
    try:
        source.write_text(plant(text, mistake["find"], mistake["replace"], source.name), encoding="utf-8")
        if errors := build(f"{program}_tests"):
            sys.exit(f"{mistake['name']} does not compile:\n{errors}")
        return run(program, test)
    finally:
        source.write_text(text, encoding="utf-8")


def main():
    mistakes = load()
    names = list(mistakes) if sys.argv[1:] == ["--all"] else sys.argv[1:]
    if not names or not mistakes.keys() >= set(names):
        sys.exit("usage: ./lab notebook mistakes --all or NAME..., of\n  " + "\n  ".join(mistakes))
    copy_sources()
    missed = []
    for name in names:
        start = time.monotonic()
        try:
            failures = failures_with(mistakes[name])
        except Stale as error:
            sys.exit(str(error))
        verdict = failures[0].splitlines()[1].strip() if failures else "NOT DETECTED"
        print(f"{name} ({time.monotonic() - start:.0f} s): {mistakes[name]['test']}: {verdict}", flush=True)
        missed += [] if failures else [name]
    if missed:
        sys.exit(f"not detected: {', '.join(missed)}")
