"""What light samples gain in fog: errors and seconds of chapter 13's strategies, for light that was scattered once and for all of it.

    ./lab notebook media_strategies [--runs 4] [--output FILE.json]

All take turns, with another seed in each run. The errors are those that the halves of the samples tell.
"""
import subprocess
import tempfile
import time
from pathlib import Path

from project import ROOT, Parser, number, program_file, read_json, show_progress, write_json
from tables.ages import stamped

CHAPTER, STRATEGIES = "13_media", ("both", "light", "bounces")
LIGHT = {"scattered once": ["--only-path-length=1"], "all light": []}


def main():
    parser = Parser("./lab notebook media_strategies", __doc__)
    parser.add_argument("--runs", type=number(int, 2), default=4, help="default: 4")
    parser.add_argument("--output", type=Path, default=ROOT / "notebook/records/media/native.json", metavar="FILE.json")
    options, rows, started = parser.parse_args(), [], time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        for light, chosen in LIGHT.items():
            products = {strategy: [] for strategy in STRATEGIES}
            for run in range(options.runs):
                for strategy, found in products.items():
                    subprocess.run([program_file(CHAPTER), "fog", "--headless", "--quiet", "--backend=native", "--width=96", "--height=64",
                                    "--samples=256", f"--seed={1 + run}", f"--strategy={strategy}", *chosen, f"--output={folder}/picture.exr",
                                    f"--report={report}"], check=True)
                    content = read_json(report)
                    found.append(content["rows"][-1]["mse"] * content["rows"][-1]["seconds"])
                show_progress("media_strategies", len(rows) * options.runs + run + 1, len(LIGHT) * options.runs, started)
            rows.append({"light": light, "mse_times_seconds": products})
    write_json(options.output, stamped({"device": content["device"], "scene": "fog", "rows": rows}), 4)
