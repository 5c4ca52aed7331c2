"""Runs GoogleTest programs and reads their JSON reports."""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

# GoogleTest's own properties of a test; everything else was recorded by the test.
OWN_KEYS = {"name", "value_param", "type_param", "file", "line", "status", "result", "timestamp", "time", "classname"}
OWN_KEYS |= {"failures", "skipped"}


@dataclass
class Test:
    """A test that ran. For "Backends/Textures.AreDecoded/query" the suite is "Textures" and the instance "query"."""

    full_name: str
    failures: list
    skipped: bool
    properties: dict  # name -> text, what the test recorded

    @property
    def name(self):
        """Suite and test without their instantiation, as tests are cited."""
        return name_of(self.full_name)

    @property
    def instance(self):
        """The parameter, or "" for a test without one."""
        _, _, test = self.full_name.partition(".")
        return test.partition("/")[2].removesuffix("_all")


def name_of(full_name):
    """ "Textures.AreDecoded" for "Backends/Textures.AreDecoded_all/query"."""
    suite, _, test = full_name.partition(".")
    return f"{suite.rpartition('/')[2]}.{test.partition('/')[0].removesuffix('_all')}"


ONLY_IN_ALL = "*_all:*_all/*"  # a filter for tests that ./lab test leaves out


def run(binary, report, *arguments, **options):
    """Starts a test program that writes its report to that file; returns its subprocess."""
    command = [binary, f"--gtest_output=json:{report}", *arguments]
    return subprocess.run(command, check=False, **options)


def read(report):
    """The tests in a report, and what was recorded for all of them (the device)."""
    contents = json.loads(Path(report).read_text(encoding="utf-8"))
    tests = [
        Test(
            f"{suite['name']}.{case['name']}",
            [failure["failure"] for failure in case.get("failures", [])],
            case["result"] == "SKIPPED",
            {key: _text(value) for key, value in case.items() if key not in OWN_KEYS},
        )
        for suite in contents["testsuites"]
        for case in suite["testsuite"]
        if case["status"] == "RUN"
    ]
    return tests, {key: _text(value) for key, value in contents.items() if isinstance(value, str)}


def _text(value):
    """GoogleTest writes each byte of UTF-8 as a separate character."""
    return value.encode("latin-1").decode("utf-8")


def list_tests(binary, *arguments):
    """Full names of all tests in a program, or of those that its arguments choose."""
    lines = subprocess.run([binary, "--gtest_list_tests", *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout
    names, suite = [], ""
    for line in lines.splitlines():
        text = line.split("#")[0].rstrip()
        if line.startswith("  "):
            names.append(suite + text.strip())
        elif text.endswith("."):
            suite = text
    return names
