"""Measures what each command costs, starting from a fresh clone: docs/records/running/NAME.json, for the table of docs/measuring.md.

Clones the last commit into a temporary folder, and runs the commands there one after the other. What they need must be installed.
The table shows CPU seconds, which depend little on the load. Building keeps all cores busy; most other commands are short.
"""
import os
import subprocess
import sys
import tempfile
import time
from datetime import datetime
from pathlib import Path

from docs.ages import stamped
from project import RECORDS, ROOT, Parser, UserError, commit, load_records, processor, run_to_end, show_progress, table, write_json

# What a reader would type. The first one builds the renderer, others what they need in addition.
COMMANDS = ["run 1 --headless", "run 1 --headless --seed 2", "run 10 --headless", "check 1", "sample cosine", "report cornell_box 1 3", "book",
            "package linux"]
LONG = ["test --quick", "test"]


def size_of(folder):
    """Disk usage of all files in a folder, in bytes."""
    return sum(path.lstat().st_blocks * 512 for path in folder.rglob("*") if not path.is_symlink())


def measured(command, clone):
    """Runs ./lab in a separate process, so that the system sums up its children's usage."""
    before, started = size_of(clone), time.monotonic()
    child = os.fork()
    if child == 0:
        with open(clone.parent / "said.txt", "wb") as said:
            code = subprocess.run([clone / "lab", *command.split()], cwd=clone, stdin=subprocess.DEVNULL, stdout=said, stderr=said,
                                  env=os.environ | {"CCACHE_DISABLE": "1", "LAB_BINARIES": str(clone / "build/bin")}).returncode
        os._exit(min(code, 255) if code >= 0 else 255)
    _, status, usage = os.wait4(child, 0)
    if status != 0:
        raise UserError(f"./lab {command}: {(clone.parent / 'said.txt').read_text(errors='replace')[-500:]}")
    return {"command": command, "seconds": time.monotonic() - started, "cpu_seconds": usage.ru_utime + usage.ru_stime,
            "largest_process_bytes": usage.ru_maxrss * 1024, "disk_bytes": max(0, size_of(clone) - before)}


def running_table():
    """What each command costs."""
    text = ""
    for record in load_records("running"):
        rows = [[f"`./lab {row['command']}`", f"{row['cpu_seconds']:.0f}", f"{row['largest_process_bytes'] / 2**20:.0f} MiB",
                 f"{row['disk_bytes'] / 2**20:.0f} MiB"] for row in record["commands"]]
        text += (f"{record['processor']}, {record['cores']} cores, {record['date']}, commit "
                 f"{record['commit']}. The clone has {record['clone_bytes'] / 2**20:.0f} MiB.\n\n"
                 + table(["command, in this order", "seconds of one core", "memory of the largest process", "more on the disk"], rows))
    return text


def main():
    parser = Parser("python3 tools running", __doc__)
    parser.add_argument("name", help="of the record")
    parser.add_argument("--tests", action="store_true", help=f"also: {', '.join(LONG)}")
    options = parser.parse_args()
    model, cores = processor()
    record = {"processor": model, "cores": cores, "load": os.getloadavg()[1],
              "date": datetime.now().strftime("%Y-%m-%d"), "commit": commit(), "commands": []}
    with tempfile.TemporaryDirectory() as folder:
        clone = Path(folder) / "lab"
        run_to_end(["git", "clone", "--quiet", "--depth", "1", f"file://{ROOT}", clone], "Cloning")
        record["clone_bytes"] = size_of(clone)
        commands, started = [*COMMANDS, *(LONG if options.tests else [])], time.monotonic()
        for done, command in enumerate(commands, 1):
            record["commands"].append(measured(command, clone))
            show_progress(command, done, len(commands), started)
    write_json(RECORDS / "running" / f"{options.name}.json", stamped(record))
    print(f"{RECORDS / 'running' / options.name}.json: python3 tools tables fills docs/measuring.md", file=sys.stderr)
