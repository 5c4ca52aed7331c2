#!/usr/bin/env python3
"""Plants a mistake in a copy of the shaders and expects the test that is meant to catch it to fail.

    LAB_BINARIES=build/bin tests/mistakes/mistake.py NAME

Exits with 0 if the test was red because an expectation failed: neither because the shader does not compile nor because the
program crashed. A substitution that does not match exactly once is stale, which is an error, too.
"""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "tools"), str(ROOT / "tests")]
import test_report  # noqa: E402  (found by the line above)
from course.mistakes import Stale, complete, plant, records, shader_of  # noqa: E402
from project import BINARIES  # noqa: E402


def load():
    """Mistakes that have a test, by name, with the shader they are planted in; the others exist for ./lab check only."""
    everything, mistakes = records(), {}
    for chapter, record in ((chapter, record) for chapter, those in everything.items() for record in those if "test" in record):
        file = shader_of(chapter, record).relative_to(ROOT).as_posix()
        mistakes.setdefault(record["name"], complete(record, everything) | {"file": file})
    return mistakes


def make(mistake, tree):
    """Copies what the test programs read into `tree`, with the mistake in it, if any."""
    for folder in ("shaders", "chapters", "tests/shaders", "tests/hard_cases", "tests/convergence"):
        shutil.copytree(ROOT / folder, tree / folder)
    (tree / "assets").symlink_to(ROOT / "assets")
    if not mistake:
        return
    shader = tree / mistake["file"]
    text = plant(shader.read_text(encoding="utf-8"), mistake["find"], mistake["replace"], mistake["file"])
    shader.write_text(text, encoding="utf-8")


def run(program, test, tree):
    """Runs tests of a program on that tree; returns all tests that ran, with the messages of their failures. Those that run only
    with ./lab test --all, whose names end in _all, run if there are no others: the longer ones of two are too slow for this."""
    # Programs look for the shaders in parent folders.
    binary = tree / "bin" / f"{program}_tests"
    binary.parent.mkdir(exist_ok=True)
    shutil.copy(BINARIES / binary.name, binary)
    report = tree / "report.json"
    report.unlink(missing_ok=True)
    environment = {**os.environ, "LAB_TEST_STOP_AT_VERDICT": "1"}
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    chosen = f"--gtest_filter={test}"
    if not test_report.list_tests(binary, chosen):
        chosen += "_all"
    result = test_report.run(binary, report, chosen, env=environment, **streams)
    if not report.exists():
        sys.exit(f"{program}_tests ended with {result.returncode} before its tests did:\n{result.stdout[-2000:]}")
    tests, _ = test_report.read(report)
    return {test.full_name: test.failures for test in tests}


def is_verdict(message):
    """Whether a failure is about the estimator: not if a test finds itself too weak or Vulkan is misused."""
    return "too weak" not in message and "validation" not in message


def main():
    mistakes = load()
    if len(sys.argv) != 2 or sys.argv[1] not in mistakes:
        sys.exit("usage: mistake.py NAME, one of\n  " + "\n  ".join(f"{n}: {m['explanation']}" for n, m in mistakes.items()))
    mistake = mistakes[sys.argv[1]]
    print(f"{mistake['name']}: {mistake['explanation']}")
    with tempfile.TemporaryDirectory() as folder:
        try:
            make(mistake, Path(folder))
        except Stale as error:
            sys.exit(str(error))
        results = run(*mistake["test"].split(".", 1), Path(folder))
    if not results:
        sys.exit(f"there is no test {mistake['test']}")
    failures = [(name, message) for name, messages in results.items() for message in messages]
    verdicts = [failure for failure in failures if is_verdict(failure[1])]
    for name, message in verdicts:
        print(f"  red: {name}: {message.splitlines()[-1]}")
        if "exception" in message:
            sys.exit(f"not a verdict but an error:\n{message}")
    if not verdicts:
        sys.exit(f"not detected: {mistake['test']} " + ("only finds itself too weak" if failures else "is green"))


if __name__ == "__main__":
    main()
