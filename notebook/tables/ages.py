"""Tells which records are older than the sources that they measured: nothing is wrong with them, they are of another renderer.

--stamp writes into records what they measured, and a row a line, if the program that made them cannot: cost_record, hardware_record,
facet_record and device_report, and those that were measured on another machine. Do it before the sources change.
"""
import json
import os
from datetime import datetime
from pathlib import Path

from project import Parser, commit, course, read_json, table, write_json
from tables.records import RECORDS
from tables.sources import changed_since, measured


def when(record):
    """Date and commit of a record, as far as it states them."""
    told = record.get("environment", record)
    return ", ".join(filter(None, [told.get("date", "")[:10], told.get("commit") and f"commit {told['commit']}"]))


def state(record):
    """In words, whether the sources are still those that were measured."""
    changed = changed_since(record)
    if changed is None:
        return "unknown: recorded before versions were stored"
    return f"older: {', '.join(changed)} changed since" if changed else "up to date"


def ages():
    """(file, date and commit, state) of all records."""
    records = [(file, read_json(file)) for file in sorted(RECORDS.glob("*/*.json"))]
    return [(file, when(record) or "no date", state(record)) for file, record in records]


def record_table(page):
    """The records that a page of results shows, and when they were measured: those of its device if there are any, or else all."""
    files = sorted(RECORDS.glob(f"*/{page.stem}.json")) or sorted(RECORDS.glob("*/*.json"))
    return table(["record", "measured"], [
        [f"[{file.relative_to(RECORDS).with_suffix('')}]({os.path.relpath(file, page.parent)})", when(read_json(file)) or "no date"] for file in files], left=2)


def stamped(record):
    """A record with a digest of what it measured, and with date and commit if it has none."""
    told = record.setdefault("environment", {}) if "environment" in record else record
    told.setdefault("commit", commit())
    told.setdefault("date", datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"))
    return record | {"measured": measured(json.dumps(record))}


def main():
    parser = Parser("./lab notebook ages", __doc__)
    parser.add_argument("--stamp", nargs="+", type=Path, default=[], metavar="FILE")
    for file in parser.parse_args().stamp:
        write_json(file, stamped(read_json(file)))
    for file, told, words in ages():
        print(f"{file.relative_to(RECORDS).with_suffix('')!s:24} {told:42} {words}")
    from learning import confusion, learn  # imported late: it imports this module
    untold, trials = learn.unmeasured(learn.read_knowledge(course())), confusion.outdated()
    print(f"{'knowledge of ./lab check':67} " + (f"older: {len(untold)} to be learnt, such as chapter {untold[0][0]}, {untold[0][1]}" if untold else "up to date"))
    print(f"{'trials of ./lab check':67} " + (f"older: {len(trials)} to be tried again, such as {trials[0]}" if trials else "up to date"))
