"""Runs the tests that docs/numerics.md cites and writes what they recorded as notebook/records/hard_cases/DEVICE.json."""
import json
import os
import re
import subprocess
import sys
import tempfile

import test_report
from cited_tests import PROGRAMS, cited_tests, is_python, python_module
from project import BINARIES, ROOT, Parser, UserError, write_json
from tables.records import RECORDS
from tables.sources import stamped


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
    Parser("./lab notebook hard_cases", __doc__).parse_args()
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
