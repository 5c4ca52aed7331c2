"""Where the records of measurements are, and how they are read."""
import os
from pathlib import Path

from project import read_json, table

NOTEBOOK = Path(__file__).resolve().parents[1]
RECORDS = NOTEBOOK / "records"


def load_records(folder):
    """The records in records/FOLDER, one for each device."""
    return [read_json(path) for path in sorted((RECORDS / folder).glob("*.json"))]


def when(record):
    """Date and commit of a record, as far as it states them."""
    told = record.get("environment", record)
    return ", ".join(filter(None, [told.get("date", "")[:10], told.get("commit") and f"commit {told['commit']}"]))


def record_table(page):
    """The records that a page of results shows, and when they were measured: those of its device if there are any, or else all."""
    files = sorted(RECORDS.glob(f"*/{page.stem}.json")) or sorted(RECORDS.glob("*/*.json"))
    return table(
        ["record", "measured"],
        [
            [
                f"[{file.relative_to(RECORDS).with_suffix('')}]({os.path.relpath(file, page.parent)})",
                when(read_json(file)) or "no date",
            ]
            for file in files
        ],
        left=2,
    )
