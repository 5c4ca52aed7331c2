"""Chooses and runs tests for ./lab test: `python3 tests targets ARGUMENTS` prints what is to be built for them, `python3 tests run ARGUMENTS`
runs them. ./lab help says what the arguments mean; others than those go to ctest.
"""
import os
import re
import subprocess
import sys
from functools import partial
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "tools"))
from cited_tests import PROGRAMS, TEST, tests_of_exercise  # noqa: E402  (found by the line above)
from kept_results import ENDED, KeptResults, outcome  # noqa: E402
from project import CHAPTERS, original, run_tool, text_of  # noqa: E402
from test_report import list_tests  # noqa: E402

BUILD = ROOT / "build"
KEPT = BUILD / "test_results.jsonl"
WRITTEN = [
    (kind, file.stem, *names)
    for kind in (*PROGRAMS, "viewer")
    for file in sorted(ROOT.glob(f"tests/{kind}/*.cpp"))
    for names in TEST.findall(text_of(file))
]  # all tests in C++
EVERYTHING = ["all", "only_in_all"]
GOES_ON = "--all" in sys.argv


def fail(message):
    sys.exit(f"lab: {message}")


def choose(words):
    """The targets to be built, and a function that then runs the chosen tests and returns whether one failed."""
    targets, choice, chapter, name, more, run = ["all"], ["-LE", "^all$"], None, "", [], run_ctest
    is_status, words = "--status" in words, iter(word for word in words if word != "--status")
    for word in words:
        if word == "--all":
            targets, choice, run = EVERYTHING, [], partial(run_all, is_status=is_status)
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
        targets, choice, run = targets_of_tests(name), ["-R", name], run_ctest
    if is_status and run is run_ctest:
        fail("--status goes with --all")
    return targets, partial(run, [*choice, *more])


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


def run_ctest(arguments, kept=None):
    """Whether a test has failed, or none has passed."""
    kept, ended = kept or KeptResults(KEPT), {}
    # One more than the number of cores, since tests wait for files and programs; more than a few would only compete for a GPU.
    jobs = min(len(os.sched_getaffinity(0)) + 1, 4)
    command = ["ctest", "--parallel", str(jobs), "--test-dir", BUILD, "--output-on-failure", "--no-tests=error", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, encoding="utf-8", errors="backslashreplace") as process:
        for line in process.stdout:
            print(line, end="", flush=True)
            if found := ENDED.match(line):
                test, words, seconds = found[1], found[2], float(found[3])
                ended[test] = (outcome(words), seconds)
                if "LAB_TEST_COPY" not in os.environ:  # whose results are not those of the sources
                    kept.note(test, *ended[test])
    print("slowest:")
    for test, (_, seconds) in sorted(ended.items(), key=lambda item: -item[1][1])[:5]:
        print(f"  {seconds:5.1f} s  {test}")
    passed, failed, skipped = (sum(result == which for result, _ in ended.values()) for which in ("green", "red", "skipped"))
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return process.returncode != 0 or passed == 0


def listed(arguments):
    """The names of the tests that these arguments of ctest choose, in its order."""
    command = ["ctest", "--test-dir", BUILD, "-N", *arguments]
    return re.findall(r"(?m)^ *Test +#\d+: (\S+)$", subprocess.run(command, capture_output=True, encoding="utf-8").stdout)


def run_all(arguments, is_status):
    """Runs those of all tests that are not green, or tells how they all stand."""
    tests, kept = listed(arguments), KeptResults(KEPT)
    if not tests:  # as ctest explains
        return run_ctest(arguments)
    if is_status:
        return kept.tell(tests)
    numbered = tests  # ctest's -I counts the tests that its other arguments choose
    if "-I" in arguments:
        at = arguments.index("-I")
        del arguments[at : at + 2]
        numbered = listed(arguments)
    numbers = {test: str(number) for number, test in enumerate(numbered, 1)}
    waiting = [numbers[test] for test in tests if kept.state(test) != "green"]
    print(f"{len(tests) - len(waiting)} of {len(tests)} tests are green since the last change of what they read")
    return bool(waiting) and run_ctest([*arguments, "-I", ",".join(["0,0,0", *waiting])], kept)


def main():
    action, *words = sys.argv[1:]
    try:
        targets, run = choose(words)
    except re.error as error:
        fail(f"-R needs a regular expression: {error}")
    print(*targets) if action == "targets" else sys.exit(run())


if __name__ == "__main__":
    run_tool(sys.modules["__main__"])
