#!/usr/bin/env python3
"""Fills the tables of hard cases and of device arithmetic in docs/numerics.md.

    tools/make_numerics.py              writes the tables from cases.json and the records in docs/records
    tools/make_numerics.py --check      only tells whether they are up to date
    tools/make_numerics.py --measure    first runs the tests that are cited and writes the record of this device

Devices' own records come from `./lab device --output docs/records/devices/DEVICE.json`.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import test_report

ROOT = Path(__file__).resolve().parents[1]
BINARIES = Path(os.environ.get("LAB_BINARIES", ROOT / "build" / "bin"))
PROGRAMS = ["unit", "shaders", "convergence", "parity", "hard_cases"]
RECORDS = ROOT / "docs" / "records"
SMALLEST_ERROR = "errors_found_from"  # recorded by tests/support/expect_statistics.cpp
PAGE = ROOT / "docs" / "numerics.md"


def load_cases():
    """The rows of the table, by the number of the trap in section 3 of our research; those without one come last."""
    cases = json.loads((ROOT / "tests" / "hard_cases" / "cases.json").read_text(encoding="utf-8"))

    def order(case):
        return tuple(map(int, case["research"].split("."))) if case["research"] else (99,)

    return sorted(cases, key=order)


def cited_tests():
    """The names of all tests that the table cites."""
    return {test for case in load_cases() for test in case["tests"]}


def is_python(test):
    """Tests of the command line are named Class.test_something."""
    return test.partition(".")[2].startswith("test_")


def python_module(test):
    """The module of tests/cli that holds a test; nothing if there is none."""
    suite, _, method = test.partition(".")
    for path in sorted((ROOT / "tests" / "cli").glob("*_test.py")):
        classes = re.split(r"(?m)^class ", path.read_text(encoding="utf-8"))[1:]
        if any(text.startswith(suite + "(") and f"def {method}(" in text for text in classes):
            return path.stem
    return None


def missing_tests():
    """Cited tests that do not exist."""
    existing = {
        test_report.name_of(name) for kind in PROGRAMS for name in test_report.list_tests(BINARIES / f"{kind}_tests")
    }
    return sorted(t for t in cited_tests() if (python_module(t) is None if is_python(t) else t not in existing))


def run_python(test):
    """Runs a test of the command line; returns what it recorded."""
    with tempfile.NamedTemporaryFile("r", suffix=".jsonl") as record:
        command = [sys.executable, "-B", "-m", "unittest", f"{python_module(test)}.{test}"]
        environment = {**os.environ, "LAB_BINARIES": str(BINARIES), "LAB_TEST_RECORD": record.name}
        subprocess.run(command, cwd=ROOT / "tests" / "cli", env=environment, check=True)
        properties = {}
        for line in record:
            properties |= json.loads(line)
        return properties


def measure():
    """Runs the cited tests and writes what they recorded; all have to pass."""
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
            sys.exit(f"nothing was written, for these tests failed: {', '.join(failed)}")
        for test in tests:
            if not test.skipped:
                measured.setdefault(test.name, {})[test.instance] = test.properties
    for test in sorted(filter(is_python, cited)):
        measured[test] = {"": run_python(test)}
    name = re.sub(r"[^a-z0-9]+", "_", device["device"].split("(")[0].strip().lower())
    file = RECORDS / "hard_cases" / f"{name}.json"
    file.parent.mkdir(exist_ok=True)
    record = {**device, "tests": dict(sorted(measured.items()))}
    file.write_text(json.dumps(record, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def load_records(folder):
    return [json.loads(path.read_text(encoding="utf-8")) for path in sorted((RECORDS / folder).glob("*.json"))]


def short_name(record):
    """The device without what its driver adds in brackets."""
    return record["device"].split("(")[0].strip()


def label(instance):
    """Short for the parameter of a test: "chapter 5" for "chapter_05_russian_roulette"."""
    chapter = re.fullmatch(r"chapter_0?(\d+)_.*", instance)
    return f"chapter {chapter[1]}" if chapter else instance


def figures(instances):
    """What the instances of a test recorded, as text; numbers that agree are told once."""
    values = {}  # name -> value -> the instances that have it
    for instance, properties in instances.items():
        for name, value in properties.items():
            if name == SMALLEST_ERROR:
                continue  # one number tells for all tests of a case
            values.setdefault(name, {}).setdefault(value, []).append(label(instance))
    texts = []
    for name, by_value in values.items():
        told = list(by_value)
        if len(by_value) > 1:
            told = [f"{value} ({', '.join(sorted(set(of)))})" for value, of in by_value.items()]
        texts.append(f"{name.replace('_', ' ')} {', '.join(told)}")
    return texts


def measured_text(case, record):
    """The cell of a case and a device."""
    texts, percents = [], []
    for test in case["tests"]:
        instances = record["tests"].get(test, {})
        percents += [float(of[SMALLEST_ERROR].rstrip(" %")) for of in instances.values() if SMALLEST_ERROR in of]
        texts += [text for text in figures(instances) if text not in texts]
    if percents:
        texts.append(f"finds errors from {max(percents):.2g} %")
    untested = [test for test in case["tests"] if test not in record["tests"]]
    if untested:
        texts.append(f"{len(untested)} of {len(case['tests'])} tests not run")
    return "; ".join(texts) or ("passes" if case["tests"] else "-")


def table(head, rows, alignment=None):
    """The lines of a Markdown table."""
    ruler = alignment or ["---"] * len(head)
    return ["| " + " | ".join(cells) + " |" for cells in [head, ruler, *rows]]


def case_table():
    """The table of hard cases, a column for each device that has been measured."""
    records = load_records("hard_cases")
    rows = []
    for case in load_cases():
        title = f"{case['research']} {case['case']}" if case["research"] else case["case"]
        we_do = case["we_do"] + (f" ({case['source']})" if case["source"] else "")
        tests = "<br>".join(f"`{test}`" for test in case["tests"]) or "none"
        rows.append([title, case["goes_wrong"], we_do, tests, *(measured_text(case, record) for record in records)])
    head = ["case", "what goes wrong", "what we do", "test", *(f"measured: {short_name(r)}" for r in records)]
    return table(head, rows)


def device_tables():
    """Largest errors of every device that ./lab device has recorded."""
    records = load_records("devices")
    names = [short_name(record) for record in records]
    numbers = ["---:"] * len(records)
    rows = []
    for i, first in enumerate(records[0]["functions"] if records else []):
        cells = []
        for record in records:
            row = record["functions"][i]
            broken = " **outside the guarantee**" if row["share_of_guarantee"] > 1 else ""
            absolute = f"{row['absolute']:.1e}, " if row["absolute"] is not None else ""
            cells.append(f"{absolute}{row['ulp']:.3g} ulp{broken}")
        arguments = first["arguments"].replace("|", "\\|")
        guaranteed = first["guaranteed"].replace("|", "\\|")
        rows.append([first["function"], arguments, guaranteed, *cells])
    lines = table(["function", "arguments", "Vulkan guarantees", *names], rows, ["---"] * 3 + numbers)
    samplers = [
        [row["sampler"], *(f"{record['samplers'][i]['absolute']:.1e}" for record in records)]
        for i, row in enumerate(records[0]["samplers"] if records else [])
    ]
    lines += ["", *table(["sampler", *names], samplers, ["---"] + numbers)]
    hits = [
        [short_name(record), f"`{row['backend']}`", row["scene"], f"{row['off_plane']:.2g}", f"{row['off_ray']:.1e}"]
        for record in records
        for row in record["hit_points"]
    ]
    head = ["device", "backend", "scene", "distance to the plane / offset", "distance to the ray / its length"]
    return lines + ["", *table(head, hits, ["---"] * 3 + ["---:"] * 2)]


def page_text():
    """docs/numerics.md with its tables filled in."""
    text = PAGE.read_text(encoding="utf-8")
    for name, lines in {"hard cases": case_table(), "device arithmetic": device_tables()}.items():
        begin, end = f"<!-- {name}: written by tools/make_numerics.py -->\n", f"<!-- end of {name} -->\n"
        before, _, rest = text.partition(begin)
        _, _, after = rest.partition(end)
        text = before + begin + "\n".join(lines) + "\n" + end + after
    return text


def main():
    if "--measure" in sys.argv:
        measure()
    text = page_text()
    if "--check" not in sys.argv:
        PAGE.write_text(text, encoding="utf-8")
    elif PAGE.read_text(encoding="utf-8") != text:
        sys.exit("docs/numerics.md is not what tools/make_numerics.py writes: run it")


if __name__ == "__main__":
    main()
