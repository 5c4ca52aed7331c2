"""What one waits for a large picture: seconds of a whole command at 3840 x 2160, by part, as medians of runs that take turns.

    ./lab notebook large_picture [--runs 5] [--output FILE.json]

The program's start is a picture of 64 x 64 pixels, and rendering is what the report of one more run says. The others are what a command
takes with an EXR, with a PNG, and with one of each; beyond start and rendering, that is reading the film back, its error and the files.
"""
import subprocess
import tempfile
import time
from pathlib import Path
from statistics import median

from project import CHAPTERS, ROOT, Parser, number, program_file, read_json, show_progress, write_json
from tables.sources import stamped

SMALL, LARGE = (64, 64), (3840, 2160)
FILES = {"EXR": ["exr"], "PNG": ["png"], "EXR and PNG": ["exr", "png"]}
SAMPLES = 64


def seconds_of(size, options, *outputs):
    """Seconds of a whole command."""
    started = time.monotonic()
    subprocess.run(
        [
            program_file(CHAPTERS[10]),
            "cornell_box",
            "--headless",
            "--quiet",
            f"--width={size[0]}",
            f"--height={size[1]}",
            f"--samples={SAMPLES}",
            f"--backend={options.backend}",
            *outputs,
        ],
        check=True,
    )
    return time.monotonic() - started


def main():
    parser = Parser("./lab notebook large_picture", __doc__)
    parser.add_argument("--runs", type=number(int, 1), default=5, help="default: 5")
    parser.add_argument("--backend", default="auto", help="default: auto")
    parser.add_argument(
        "--output", type=Path, default=ROOT / "notebook/records/large_picture/nvidia_h200.json", metavar="FILE.json"
    )
    options, started, found = parser.parse_args(), time.monotonic(), []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        outputs = {kind: [f"--output={folder / f'picture.{ending}'}" for ending in endings] for kind, endings in FILES.items()}
        seconds_of(LARGE, options, *outputs["EXR"], f"--report={folder / 'report.json'}")  # fills caches, too
        report = read_json(folder / "report.json")
        for run in range(options.runs):
            found.append(
                {"start": seconds_of(SMALL, options, *outputs["EXR and PNG"])}
                | {kind: seconds_of(LARGE, options, *outputs[kind]) for kind in FILES}
            )
            show_progress("large_picture", run + 1, options.runs, started)
    seconds = {part: median(run[part] for run in found) for part in found[0]}
    start, rendering = seconds.pop("start"), report["rows"][-1]["seconds"]
    rows = {kind: {"seconds": whole, "beyond start and rendering": whole - start - rendering} for kind, whole in seconds.items()}
    write_json(
        options.output,
        stamped({"device": report["device"], "samples": SAMPLES, "start": start, "rendering": rendering, "files": rows}),
    )
