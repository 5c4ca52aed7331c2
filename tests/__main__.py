"""Chooses and runs tests for ./lab test: `python3 tests targets ARGUMENTS` prints what is to be built for them, `python3 tests run ARGUMENTS`
runs them. ./lab help says what the arguments mean; others than those go to ctest.
"""
import os
import re
import subprocess
import sys
from functools import partial
from pathlib import Path
from xml.etree import ElementTree

TESTS = Path(__file__).resolve().parent
sys.path.append(str(TESTS.parent / "tools"))
from cited_tests import PROGRAMS, TEST, tests_of_exercise  # noqa: E402  (found by the line above)
from project import CHAPTERS, ROOT, original, run_tool  # noqa: E402
from test_report import list_tests  # noqa: E402

BUILD = ROOT / "build"
EVERYTHING = ["all", "only_in_all"]
RUNS = {None: (["all"], ["-LE", "^all$"]), "--quick": (["quick_tests"], ["-L", "^quick$"]), "--all": (EVERYTHING, [])}  # targets, choice of ctest


def fail(message):
    sys.exit(f"lab: {message}")


def choose(words):
    """The targets to be built, and a function that then runs the chosen tests and returns whether one failed."""
    (targets, choice), chapter, name, others, words = RUNS[None], None, "", [], iter(words)
    for word in words:
        if word in RUNS:
            targets, choice = RUNS[word]
        elif word.startswith("-R"):
            name = word[2:] or next(words, "") or fail("-R needs the name of a test or a part of it")
        elif re.fullmatch("[0-9]{1,2}", word):
            chapter = int(word) if int(word) in CHAPTERS else fail(f"there is no chapter {word}; ./lab run lists them")
        else:
            others.append(word)
    if chapter:
        os.environ["LAB_TEST_COPY"] = CHAPTERS[chapter]
        chapter = CHAPTERS[original(chapter)]
        other_chapters = [folder for folder in CHAPTERS.values() if folder != chapter]
        if not name:
            suites = tests_of_exercise(chapter) or fail(f"the page of {chapter} names no tests: choose some by -R")
            if not others:
                targets = targets_of_exercise(chapter, suites)
                return targets, partial(run_exercise, chapter, suites, other_chapters, targets)
            name = rf"[./]({'|'.join(suites)})\."
        others += ["-E", f"/chapter_({'|'.join(other_chapters)})(_all)?$"]
    if name:
        targets, choice = targets_of_tests(name), ["-R", name]
    return targets, partial(run_ctest, [*choice, *others])


def tests_in(file):
    return TEST.findall(file.read_text(encoding="utf-8"))


def targets_of_exercise(chapter, suites):
    """The files alone that have these tests."""
    files = [file for file in sorted(TESTS.glob("*/*.cpp")) if any(suite in suites for suite, _ in tests_in(file))]
    return [f"{file.parent.name}_{file.stem}" for file in files] or fail(f"no test is named {' or '.join(suites)}, as the page of {chapter} says")


def targets_of_tests(name):
    """The test programs with tests whose names match, or all if others match."""
    kinds = {kind: f"{kind}.{suite}.{test}" for kind in [*PROGRAMS, "viewer"] for file in (TESTS / kind).glob("*.cpp")
             for suite, test in tests_in(file) if re.search(name, f"{kind}.{suite}.{test}")}
    classes = [f"cli.{found}" for file in TESTS.glob("cli/*_test.py") for found in re.findall(r"(?m)^class (\w+)", file.read_text(encoding="utf-8"))]
    start_programs = "mistake" in name or any(re.search(name, found) for found in classes)  # as those in Python do
    return [f"{kind}_tests" for kind in kinds] if kinds and not start_programs else EVERYTHING


def run_exercise(chapter, suites, other_chapters, targets):
    own = ":".join(f"{suite}.*:*/{suite}.*" for suite in suites)
    chosen = f"--gtest_filter={own}-" + ":".join(f"*/chapter_{other}:*/chapter_{other}_all" for other in other_chapters)
    failed = False
    for target in targets:
        # As in tests/CMakeLists.txt: Mesa's driver for CPUs takes long to optimise.
        unoptimised = {} if target.startswith("convergence_") else {"GALLIVM_PERF": "nopt"}
        failed |= subprocess.run([BUILD / "bin" / target, "--gtest_brief=1", chosen], env=os.environ | unoptimised).returncode != 0
    if not failed and not any(list_tests(BUILD / "bin" / target, chosen) for target in targets):
        fail(f"{chapter} has no tests named {' or '.join(suites)}")
    return failed


def run_ctest(arguments):
    results = BUILD / "tests.xml"
    results.unlink(missing_ok=True)
    # One more than the number of cores, since tests wait for files and programs; more than a few would only compete for a GPU.
    jobs = min(len(os.sched_getaffinity(0)) + 1, 4)
    code = subprocess.run(["ctest", "--parallel", str(jobs), "--test-dir", BUILD, "--output-on-failure", "--no-tests=error",
                           "--output-junit", results, *arguments]).returncode
    cases = list(ElementTree.parse(results).iter("testcase")) if results.exists() else []
    passed = sum(case.get("status") == "run" for case in cases)
    skipped = sum(case.get("status") == "disabled" or case.find("skipped") is not None and case.find("skipped").get("message").startswith("SKIP_")
                  for case in cases)
    print("slowest:")
    for case in sorted(cases, key=lambda case: float(case.get("time")), reverse=True)[:5]:
        print(f"  {float(case.get('time')):5.1f} s  {case.get('name')}")
    print(f"{passed} passed, {len(cases) - passed - skipped} failed" + (f", {skipped} skipped" if skipped else ""))
    return code != 0 or passed == 0


def main():
    action, *words = sys.argv[1:]
    targets, run = choose(words)
    if action == "run":
        sys.exit(run())
    print(*targets)


if __name__ == "__main__":
    run_tool(sys.modules["__main__"])
