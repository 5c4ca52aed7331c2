"""The tables of hard cases and device arithmetic in docs/numerics.md."""
import re

from cited_tests import load_cases
from project import table
from tables.records import load_records

SMALLEST_ERROR = "errors_found_from"  # recorded by tests/support/expect_statistics.cpp


def short_name(record):
    """The device's name without the driver's addition in brackets."""
    return record["device"].split("(")[0].strip()


def label(instance):
    """A short name for a test's parameter: "chapter 5" for "chapter_05_russian_roulette"."""
    chapter = re.fullmatch(r"chapter_0?(\d+)_.*", instance)
    return f"chapter {chapter[1]}" if chapter else instance


def figures(instances):
    """The numbers that a test's instances recorded, as text; equal numbers are given once."""
    values = {}  # name -> value -> the instances that have it
    for instance, properties in instances.items():
        for name, value in properties.items():
            if name == SMALLEST_ERROR:
                continue  # measured_text() gives a case's largest one
            values.setdefault(name, {}).setdefault(value, []).append(label(instance))
    texts = []
    for name, by_value in values.items():
        told = list(by_value)
        if len(by_value) > 1:
            told = [f"{value} ({', '.join(sorted(set(of)))})" for value, of in by_value.items()]
        texts.append(f"{name.replace('_', ' ')} {', '.join(told)}")
    return texts


def measured_text(case, record):
    """The table cell for a case and a device."""
    texts, percents = [], []
    for test in case["tests"]:
        instances = record["tests"].get(test, {})
        percents += [float(of[SMALLEST_ERROR].rstrip(" %")) for of in instances.values() if SMALLEST_ERROR in of]
        texts += [text for text in figures(instances) if text not in texts]
    if percents:
        texts.append(f"finds errors from {max(percents):.2g} %")
    untested = [test for test in case["tests"] if test not in record["tests"]]
    if untested:  # they are newer than the record
        part = f"{len(untested)} of {len(case['tests'])} tests " if len(untested) < len(case["tests"]) else ""
        texts.append(f"{part}not measured yet")
    return "; ".join(texts) or ("passes" if case["tests"] else "-")


def case_table():
    """The table of hard cases, with a column for each measured device."""
    records = load_records("hard_cases")
    rows = []
    for case in load_cases():
        title = f"{case['research']} {case['case']}" if case["research"] else case["case"]
        we_do = case["we_do"] + (f" ({case['source']})" if case["source"] else "")
        tests = "<br>".join(f"`{test}`" for test in case["tests"]) or "none"
        rows.append([title, case["goes_wrong"], we_do, tests, *(measured_text(case, record) for record in records)])
    head = ["case", "what goes wrong", "what we do", "test", *(f"measured: {short_name(r)}" for r in records)]
    return table(head, rows, left=len(head))


def device_tables():
    """The largest errors of each device recorded by ./lab notebook device_report."""
    records = load_records("devices")
    names = [short_name(record) for record in records]
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
    text = table(["function", "arguments", "Vulkan guarantees", *names], rows, left=3)
    samplers = [
        [row["sampler"], *(f"{record['samplers'][i]['absolute']:.1e}" for record in records)]
        for i, row in enumerate(records[0]["samplers"] if records else [])
    ]
    text += "\n" + table(["sampler", *names], samplers)
    hits = [
        [short_name(record), f"`{row['backend']}`", row["scene"], f"{row['off_plane']:.2g}", f"{row['off_ray']:.1e}"]
        for record in records
        for row in record["hit_points"]
    ]
    head = ["device", "backend", "scene", "distance to the plane / offset", "distance to the ray / its length"]
    return text + "\n" + table(head, hits, left=3)
