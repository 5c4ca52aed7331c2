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

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "tools"))
from cited_tests import PROGRAMS, TEST, tests_of_exercise  # noqa: E402  (found by the line above)
from project import CHAPTERS, original, run_tool, text_of  # noqa: E402
from test_report import list_tests  # noqa: E402

BUILD = ROOT / "build"
WRITTEN = [
    (kind, file.stem, *names)
    for kind in (*PROGRAMS, "viewer")
    for file in sorted(ROOT.glob(f"tests/{kind}/*.cpp"))
    for names in TEST.findall(text_of(file))
]  # all tests in C++
EVERYTHING = ["all", "only_in_all"]


def fail(message):
    sys.exit(f"lab: {message}")


def choose(words):
    """The targets to be built, and a function that then runs the chosen tests and returns whether one failed."""
    targets, choice, chapter, name, more, words = ["all"], ["-LE", "^all$"], None, "", [], iter(words)
    for word in words:
        if word == "--all":
            targets, choice = EVERYTHING, []
        elif word == "--quick":
            targets, choice = ["quick_tests"], ["-L", "^quick$"]
        elif word.startswith("-R"):
            name = word[2:] or next(words, "") or fail("-R needs the name of a test or a part of it")
        elif re.fullmatch("[0-9]{1,2}", word):
            chapter = int(word) if int(word) in CHAPTERS else fail(f"there is no chapter {word}; ./lab run lists them")
        else:
            more.append(word)
    if chapter:
        os.environ["LAB_TEST_COPY"] = CHAPTERS[chapter]
        chapter = CHAPTERS[original(chapter)]
        others = [folder for folder in CHAPTERS.values() if folder != chapter]
        suites = [] if name else tests_of_exercise(chapter) or fail(f"the page of {chapter} names no tests: choose some by -R")
        if suites and not more:
            return exercise(chapter, suites, others)
        name = name or rf"[./]({'|'.join(suites)})\."
        more += ["-E", f"/chapter_({'|'.join(others)})(_all)?$"]
    if name:
        targets, choice = targets_of_tests(name), ["-R", name]
    return targets, partial(run_ctest, [*choice, *more])


def targets_of_tests(name):
    """The test programs with tests whose names match, or all if others match."""
    kinds = dict.fromkeys(kind for kind, _, suite, test in WRITTEN if re.search(name, f"{kind}.{suite}.{test}"))
    classes = [
        f"cli.{found}" for file in ROOT.glob("tests/cli/*_test.py") for found in re.findall(r"(?m)^class (\w+)", text_of(file))
    ]
    start_programs = "mistake" in name or any(re.search(name, found) for found in classes)  # as those in Python do
    return [f"{kind}_tests" for kind in kinds] if kinds and not start_programs else EVERYTHING


def exercise(chapter, suites, others):
    """The same as choose() for the tests of an exercise: the files alone that have them are built."""
    targets = dict.fromkeys(f"{kind}_{file}" for kind, file, suite, _ in WRITTEN if suite in suites)
    own = ":".join(f"{suite}.*:*/{suite}.*" for suite in suites)
    chosen = f"--gtest_filter={own}-" + ":".join(f"*/chapter_{other}:*/chapter_{other}_all" for other in others)

    def run():
        failed = False
        for target in targets:
            # As in tests/CMakeLists.txt: Mesa's driver for CPUs takes long to optimise.
            environment = os.environ | ({} if target.startswith("convergence_") else {"GALLIVM_PERF": "nopt"})
            failed |= (
                subprocess.run([BUILD / "bin" / target, "--gtest_brief=1", chosen], cwd=ROOT, env=environment).returncode != 0
            )
        if not failed and not any(list_tests(BUILD / "bin" / target, chosen) for target in targets):
            fail(f"{chapter} has no tests named {' or '.join(suites)}")
        return failed

    return targets or fail(f"no test is named {' or '.join(suites)}, as the page of {chapter} says"), run


def run_ctest(arguments):
    results = BUILD / "tests.xml"
    results.unlink(missing_ok=True)
    # One more than the number of cores, since tests wait for files and programs; more than a few would only compete for a GPU.
    jobs = min(len(os.sched_getaffinity(0)) + 1, 4)
    code = subprocess.run(
        [
            "ctest",
            "--parallel",
            str(jobs),
            "--test-dir",
            BUILD,
            "--output-on-failure",
            "--no-tests=error",
            "--output-junit",
            results,
            *arguments,
        ]
    ).returncode
    cases = list(ElementTree.parse(results).iter("testcase")) if results.exists() else []
    passed = sum(case.get("status") == "run" for case in cases)
    skipped = sum(
        case.get("status") == "disabled" or any(why.get("message").startswith("SKIP_") for why in case.iter("skipped"))
        for case in cases
    )
    print("slowest:")
    for case in sorted(cases, key=lambda case: -float(case.get("time")))[:5]:
        print(f"  {float(case.get('time')):5.1f} s  {case.get('name')}")
    print(f"{passed} passed, {len(cases) - passed - skipped} failed" + (f", {skipped} skipped" if skipped else ""))
    return code != 0 or passed == 0


def main():
    action, *words = sys.argv[1:]
    try:
        targets, run = choose(words)
    except re.error as error:
        fail(f"-R needs a regular expression: {error}")
    print(*targets) if action == "targets" else sys.exit(run())


if __name__ == "__main__":
    run_tool(sys.modules["__main__"])
