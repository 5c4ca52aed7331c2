"""Where do the minutes of ./lab test go? Lists its longest tests and build steps, from what ctest and ninja have noted of the last runs.

Each row is the wall time of one test or step while others ran beside it, so the sums say where the time goes, not how long you wait.
"""
from collections import defaultdict
from pathlib import Path

from project import ROOT, Parser, UserError, number

COSTS, LOG = "Testing/Temporary/CTestCostData.txt", ".ninja_log"


def seconds_of_tests(build):
    """{name: seconds} of the tests that ctest has run in a build folder, each as the mean of its runs."""
    rows = (build / COSTS).read_text(encoding="utf-8").partition("\n---")[0].splitlines()
    return {name: float(cost) for name, runs, cost in (row.rsplit(" ", 2) for row in rows) if int(runs)}


def seconds_of_steps(build):
    """{file: seconds} of the files that ninja has made there, each as the last time."""
    rows = [row.split("\t") for row in (build / LOG).read_text(encoding="utf-8").splitlines()[1:]]
    return {file: (int(end) - int(start)) / 1000 for start, end, _, file, _ in rows}


def room_of(name):
    """What a test or a step belongs to: the kind of the test; for a step whether it links, or what it compiles for."""
    if "/" not in name.split(".")[0]:
        return f"tests {name.split('.')[0]}"
    return "linking" if name.startswith("bin/") else f"compiling {name.partition('CMakeFiles/')[2].partition('.dir')[0]}"


def main():
    parser = Parser("./lab notebook waits", __doc__)
    parser.add_argument("--build", type=Path, default=ROOT / "build", metavar="FOLDER", help="default: build")
    parser.add_argument("--rows", type=number(int, 1), default=10, help="of each table; default: 10")
    options = parser.parse_args()
    try:
        tests, steps = seconds_of_tests(options.build), seconds_of_steps(options.build)
    except OSError as error:
        raise UserError(f"{error}: run ./lab test first") from None
    rooms = defaultdict(float)
    for name, seconds in (tests | steps).items():
        rooms[room_of(name)] += seconds
    for title, table in (("test", tests), ("step of the build", steps), ("together", rooms)):
        print(f"| {title} | seconds |\n| --- | ---: |")
        for name, seconds in sorted(table.items(), key=lambda row: -row[1])[: options.rows]:
            print(f"| {name} | {seconds:.1f} |")
        print(f"| all {len(table)} | {sum(table.values()):.0f} |\n")
