"""Tells which records in docs/records are older than the sources that they measured.

--stamp writes into records what they measured, if the program that made them cannot: those of build/bin/cost_record,
build/bin/hardware_record, build/bin/facet_record and ./lab device, and those that were measured on another machine. Do it before the
sources change.
"""
import json
import os
from datetime import datetime
from pathlib import Path

from project import RECORDS, Parser, commit, read_json, table, write_json
from report.sources import changed_since, measured


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


def ages(stem="*"):
    """(file, date and commit, state) of the records of a device, or of all."""
    records = [(file, read_json(file)) for file in sorted(RECORDS.glob(f"*/{stem}.json"))]
    return [(file, when(record) or "no date", state(record)) for file, record in records]


def age_table(page):
    """The lines for a page of results: on its device's records if there are any, or else on all."""
    found = ages(page.stem)
    return table(["record", "measured", "and now"], [
        [f"[{file.relative_to(RECORDS).with_suffix('')}]({os.path.relpath(file, page.parent)})", told, words] for file, told, words in found or ages()], left=3)


def stamped(record):
    """A record with a digest of what it measured, and with date and commit if it has none."""
    told = record.setdefault("environment", {}) if "environment" in record else record
    told.setdefault("commit", commit())
    told.setdefault("date", datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"))
    return record | {"measured": measured(json.dumps(record))}


def main():
    parser = Parser("python3 tools ages", __doc__)
    parser.add_argument("--stamp", nargs="+", type=Path, default=[], metavar="FILE")
    for file in parser.parse_args().stamp:
        write_json(file, stamped(read_json(file)))
    for file, told, words in ages():
        print(f"{file.relative_to(RECORDS).with_suffix('')!s:24} {told:42} {words}")
