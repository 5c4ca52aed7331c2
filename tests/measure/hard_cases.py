#!/usr/bin/env python3
"""Runs the tests that docs/numerics.md cites and writes what they recorded as docs/records/hard_cases/DEVICE.json."""
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path += [str(TESTS), str(TESTS.parent / "tools")]
import project  # noqa: E402  (found by the line above)
import test_report  # noqa: E402
from docs.ages import stamped  # noqa: E402
from docs.numerics import load_cases  # noqa: E402
from project import BINARIES, RECORDS, ROOT, Parser, UserError, write_json  # noqa: E402

PROGRAMS = ["unit", "shaders", "convergence", "parity", "hard_cases"]


def cited_tests():
    """The names of all tests that the table cites."""
    return {test for case in load_cases() for test in case["tests"]}


def is_python(test):
    """Command line tests are named Class.test_something."""
    return test.partition(".")[2].startswith("test_")


def python_module(test):
    """The module of tests/cli that contains a test, or None."""
    suite, _, method = test.partition(".")
    for path in sorted((ROOT / "tests" / "cli").glob("*_test.py")):
        classes = re.split(r"(?m)^class ", path.read_text(encoding="utf-8"))[1:]
        if any(text.startswith(suite + "(") and f"def {method}(" in text for text in classes):
            return path.stem
    return None


def missing_tests():
    """Cited tests that do not exist."""
    existing = {test_report.name_of(name) for kind in PROGRAMS for name in test_report.list_tests(BINARIES / f"{kind}_tests")}
    return sorted(t for t in cited_tests() if (python_module(t) is None if is_python(t) else t not in existing))


def run_python(test):
    """Runs a command line test; returns what it recorded."""
    with tempfile.NamedTemporaryFile("r", suffix=".jsonl") as record:
        command = [sys.executable, "-B", "-m", "unittest", f"{python_module(test)}.{test}"]
        environment = {**os.environ, "LAB_BINARIES": str(BINARIES), "LAB_TEST_RECORD": record.name}
        subprocess.run(command, cwd=ROOT / "tests" / "cli", env=environment, check=True)
        properties = {}
        for line in record:
            properties |= json.loads(line)
        return properties


def main():
    Parser("tests/measure/hard_cases.py", __doc__).parse_args()
    cited, measured, device = cited_tests(), {}, {}
    for kind in PROGRAMS:
        binary = BINARIES / f"{kind}_tests"
        names = [n for n in test_report.list_tests(binary) if test_report.name_of(n) in cited]
        if not names:
            continue
        with tempfile.NamedTemporaryFile(suffix=".json") as report:
            test_report.run(binary, report.name, "--gtest_filter=" + ":".join(names), "--gtest_brief=1")
            tests, of_all = test_report.read(report.name)
        device |= {key: of_all[key] for key in ("device", "driver", "api_version") if key in of_all}
        failed = [test.full_name for test in tests if test.failures]
        if failed:
            raise UserError(f"nothing was written, for these tests failed: {', '.join(failed)}")
        for test in tests:
            if not test.skipped:
                measured.setdefault(test.name, {})[test.instance] = test.properties
    for test in sorted(filter(is_python, cited)):
        measured[test] = {"": run_python(test)}
    name = re.sub(r"[^a-z0-9]+", "_", device["device"].split("(")[0].strip().lower())
    write_json(RECORDS / "hard_cases" / f"{name}.json", stamped({**device, "tests": dict(sorted(measured.items()))}))


if __name__ == "__main__":
    project.run_tool(sys.modules[__name__])
