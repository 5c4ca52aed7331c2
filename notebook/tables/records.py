"""Where the records of measurements are, and how they are read."""
from pathlib import Path

from project import read_json

NOTEBOOK = Path(__file__).resolve().parents[1]
RECORDS = NOTEBOOK / "records"


def load_records(folder):
    """The records in records/FOLDER, one for each device."""
    return [read_json(path) for path in sorted((RECORDS / folder).glob("*.json"))]
