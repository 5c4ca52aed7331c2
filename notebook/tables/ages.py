"""Tells which records are older than the sources that they measured: nothing is wrong with them, they are of another renderer.

--stamp writes into records what they measured, and a row a line, if the program that made them cannot: cost_record, hardware_record,
facet_record and device_report, and those that were measured on another machine. Do it before the sources change.
"""
from pathlib import Path

from learning import confusion, learn
from project import Parser, course, read_json, write_json
from tables.records import RECORDS, when
from tables.sources import changed_since, stamped


def state(record):
    """In words, whether the sources are still those that were measured."""
    changed = changed_since(record)
    if changed is None:
        return "unknown: recorded before versions were stored"
    return f"older: {', '.join(changed)} changed since" if changed else "up to date"


def main():
    parser = Parser("./lab notebook ages", __doc__)
    parser.add_argument("--stamp", nargs="+", type=Path, default=[], metavar="FILE")
    for file in parser.parse_args().stamp:
        write_json(file, stamped(read_json(file)))
    for file in sorted(RECORDS.glob("*/*.json")):
        record = read_json(file)
        print(f"{file.relative_to(RECORDS).with_suffix('')!s:24} {when(record) or 'no date':42} {state(record)}")
    untold, trials = learn.unmeasured(learn.read_knowledge(course())), confusion.outdated()
    print(
        f"{'knowledge of ./lab check':67} "
        + (f"older: {len(untold)} to be learnt, such as chapter {untold[0][0]}, {untold[0][1]}" if untold else "up to date")
    )
    print(
        f"{'trials of ./lab check':67} "
        + (f"older: {len(trials)} to be tried again, such as {trials[0]}" if trials else "up to date")
    )
