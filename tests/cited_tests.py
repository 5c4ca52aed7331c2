"""Which tests exist, those that an exercise names, and those that docs/numerics.md cites for each hard case of the numerics: those in
hard_cases/cases.json."""
import re
from pathlib import Path

import test_report
from project import BINARIES, ROOT, read_json, text_of

TESTS = Path(__file__).resolve().parent
TEST = re.compile(r"^TEST(?:_[PF])?\((\w+), (\w+)\)", re.MULTILINE)
PROGRAMS = ["unit", "shaders", "convergence", "parity", "hard_cases"]


def written_tests():
    """(suite, test) of everything that the sources of the tests in C++ define, whether it is built or not."""
    return {pair for file in TESTS.rglob("*.cpp") for pair in TEST.findall(file.read_text(encoding="utf-8"))}


def tests_of_exercise(chapter):
    """The names of the tests that show that exercise 1 on a chapter's page is done."""
    page = " ".join(text_of(ROOT / "chapters" / chapter / "README.md").split())
    sentence = re.search("Done when all tests named ([^.,]*)", page)
    return re.findall("`([A-Za-z]+)`", sentence[1]) if sentence else []


def load_cases():
    """The hard cases in the order of section 3 of our research; those it does not list come last."""
    cases = read_json(TESTS / "hard_cases/cases.json")

    def order(case):
        return tuple(map(int, case["research"].split("."))) if case["research"] else (99,)

    return sorted(cases, key=order)


def cited_tests():
    """The names of all tests that the table cites."""
    return {test for case in load_cases() for test in case["tests"]}


def is_python(test):
    """Command line tests are named Class.test_something."""
    return test.partition(".")[2].startswith("test_")


def python_module(test):
    """The module of tests/cli that contains a test, or None."""
    suite, _, method = test.partition(".")
    for path in sorted((TESTS / "cli").glob("*_test.py")):
        classes = re.split(r"(?m)^class ", path.read_text(encoding="utf-8"))[1:]
        if any(text.startswith(suite + "(") and f"def {method}(" in text for text in classes):
            return path.stem
    return None


def missing_tests():
    """Cited tests that do not exist."""
    existing = {test_report.name_of(name) for kind in PROGRAMS for name in test_report.list_tests(BINARIES / f"{kind}_tests")}
    return sorted(t for t in cited_tests() if (python_module(t) is None if is_python(t) else t not in existing))
