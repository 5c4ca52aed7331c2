"""What light samples gain in fog: errors and CPU seconds of chapter 13's ways to sample, for light that was scattered once and for all.

    ./lab notebook media_strategies [--runs 8] [--output FILE.json]

All take turns, with another seed in each run. The errors of all light are those against the reference, the others those that the halves
of the samples tell.
"""
import tempfile
import time
from pathlib import Path

from measure.turns import rendered
from project import ROOT, Parser, number, show_progress, write_json
from tables.sources import stamped

CHAPTER = "13_media"
WAYS = {
    "both": [],
    "light": ["--strategy=light"],
    "bounces": ["--strategy=bounces"],
    "equiangular": ["--distance-sampling=equiangular"],
}
ONCE = ["--only-path-length=1", "--max-path-length=1"]
LIGHT = {
    "scattered once": ONCE,
    "scattered once, beside the lamp": [*ONCE, "--camera-target=0.2,1,-1.1", "--vertical-fov=6"],
    "all light": ["--max-path-length=5", f"--reference={ROOT / 'assets/references/fog_5.exr'}"],
}


def main():
    parser = Parser("./lab notebook media_strategies", __doc__)
    parser.add_argument("--runs", type=number(int, 2), default=8, help="default: 8")
    parser.add_argument("--output", type=Path, default=ROOT / "notebook/records/media/native.json", metavar="FILE.json")
    options, rows, started = parser.parse_args(), [], time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for light, chosen in LIGHT.items():
            products = {way: [] for way in WAYS}
            for run in range(options.runs):
                for way, found in products.items():
                    report = rendered(
                        CHAPTER,
                        "fog",
                        Path(folder),
                        "--backend=native",
                        "--width=192",
                        "--height=128",
                        "--samples=64",
                        f"--seed={1 + run}",
                        *WAYS[way],
                        *chosen,
                    )
                    row = report["rows"][-1]
                    found.append(row["mse"] * row["cpu_seconds"])
                show_progress("media_strategies", len(rows) * options.runs + run + 1, len(LIGHT) * options.runs, started)
            rows.append({"light": light, "mse_times_cpu_seconds": products})
    write_json(options.output, stamped({"device": report["device"], "scene": "fog", "rows": rows}))
