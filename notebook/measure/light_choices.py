"""What the tree over emissive triangles gains: errors and seconds of chapter 14 with each way to choose a lamp.

    ./lab notebook light_choices [--runs 4] [--backend compute --samples 256] [--output FILE.json]

All take turns, with another seed in each run. The errors are those that the halves of the samples tell. The seconds are those of the
device, or with the backend native those of all processors together.
"""
import subprocess
import tempfile
import time
from pathlib import Path

from project import ROOT, Parser, number, program_file, read_json, show_progress, write_json
from tables.sources import stamped

CHAPTER, CHOICES = "14_many_lights", ("tree", "power", "uniform")
SCENES, SIZE = ("lamps", "city", "heart_light", "cornell_box"), 256


def main():
    parser = Parser("./lab notebook light_choices", __doc__)
    parser.add_argument("--runs", type=number(int, 2), default=4, help="default: 4")
    parser.add_argument("--backend", default="native", help="default: native")
    parser.add_argument("--samples", type=number(int, 2), default=32, help="per pixel; default: 32")
    parser.add_argument("--output", type=Path, default=ROOT / "notebook/records/lights/native.json", metavar="FILE.json")
    options, rows, started = parser.parse_args(), [], time.monotonic()
    seconds = "cpu_seconds" if options.backend == "native" else "device_seconds"
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        for scene in SCENES:
            found = {choice: {"rel_mse": [], "seconds": []} for choice in CHOICES}
            for run in range(options.runs):
                for choice, numbers in found.items():
                    subprocess.run(
                        [
                            program_file(CHAPTER),
                            scene,
                            "--headless",
                            "--quiet",
                            f"--backend={options.backend}",
                            f"--width={SIZE}",
                            f"--height={SIZE}",
                            f"--samples={options.samples}",
                            f"--seed={1 + run}",
                            f"--light-choice={choice}",
                            f"--output={folder}/picture.exr",
                            f"--report={report}",
                        ],
                        check=True,
                    )
                    content = read_json(report)
                    numbers["rel_mse"].append(content["rows"][-1]["rel_mse"])
                    numbers["seconds"].append(content["rows"][-1][seconds])
                show_progress("light_choices", len(rows) * options.runs + run + 1, len(SCENES) * options.runs, started)
            rows.append({"scene": scene, **found})
    write_json(
        options.output,
        stamped(
            {"device": content["device"], "backend": options.backend, "size": SIZE, "samples": options.samples, "rows": rows}
        ),
    )
