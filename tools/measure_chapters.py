#!/usr/bin/env python3
"""Measures what each chapter's technique gains: error, rays and time on the same scenes, interleaved in one run.

Writes a record for tools/make_results.py (default: docs/records/chapters/DEVICE.json) and, with --pictures, a picture of
each chapter for about the same number of rays to docs/pictures. Run it on a machine that does nothing else.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CHAPTERS = [
    "01_uniform_sampling",
    "02_cosine_sampling",
    "03_next_event_estimation",
    "04_splitting",
    "05_russian_roulette",
    "06_dielectrics",
]
# Scenes with the path length of their reference, which is what errors are measured against.
SCENES = {"cornell_box": 6, "torus": 5, "heart_light": 4}
SIZE = 128  # of the references
# Samples a pixel of a run, about as many rays in each.
SAMPLES = {1: 64, 2: 64, 3: 64, 4: 16, 5: 16}
# The blog's setting: two branches at every hit, light that is reflected up to five times.
BLOG = ["--split-every-hit", "--splitting-factor", "2", "--max-path-length", "5", "--samples", "16"]


def cases():
    """(scene, label, chapter, options) of everything that is measured; neighbours are compared with each other."""
    for scene in SCENES:
        for number in range(1, 6):
            yield scene, f"chapter {number}", CHAPTERS[number - 1], ["--samples", str(SAMPLES[number])]
    for scene in ("cornell_box", "heart_light"):
        for factor in (1, 2, 4, 8, 16):
            options = ["--samples", str(64 // factor), "--splitting-factor", str(factor)]
            yield scene, f"splitting factor {factor}", CHAPTERS[3], options
        for start in (1, 2, 3, 4):
            yield scene, f"roulette start {start}", CHAPTERS[4], ["--samples", "16", "--roulette-start", str(start)]
    yield "cornell_box", "splitting at every hit", CHAPTERS[3], BLOG
    yield "cornell_box", "the same with roulette", CHAPTERS[4], [*BLOG, "--roulette-start", "1"]


def run(chapter, arguments):
    """The report of a run and what it printed."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        command = [ROOT / "build/bin" / chapter, *arguments, "--report", report]
        if "--output" not in arguments:
            command += ["--output", Path(folder) / "picture.exr"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return json.loads(report.read_text(encoding="utf-8"))


def measure(arguments):
    """The record."""
    listed = list(cases())
    rows = [{"scene": s, "case": label, "chapter": c, "options": " ".join(o), "runs": []} for s, label, c, o in listed]
    common = ["--width", str(SIZE), "--height", str(SIZE), "--backend", arguments.backend]
    for repetition in range(arguments.repetitions):
        for row, (scene, label, chapter, options) in zip(rows, listed):
            print(f"\r\033[K{repetition + 1}/{arguments.repetitions} {scene} {label}", end="", file=sys.stderr, flush=True)
            # The blog's length has no reference: there the error is estimated from two halves of the samples.
            length = SCENES[scene]
            reference = ["--max-path-length", str(length), "--reference", ROOT / f"assets/references/{scene}_{length}.exr"]
            further = [] if "--max-path-length" in options else reference
            report = run(chapter, [scene, *common, *options, *further, "--seed", str(repetition + 1)])
            last = report["rows"][-1]
            keys = ("samples", "rel_mse", "rays", "device_seconds")
            row["runs"].append({key: last[key] for key in keys})
    print(file=sys.stderr)
    return {"device": report["device"], "backend": arguments.backend, "size": SIZE, "rows": rows}


def render_pictures(arguments):
    """One picture a chapter for about the same number of rays, of the Cornell box or what the chapter is about."""
    for number, chapter in enumerate(CHAPTERS, 1):
        picture = ROOT / "docs/pictures" / f"{chapter}.png"
        size = ["--width", "320", "--height", "320", "--backend", arguments.backend]
        pilot = run(chapter, [*size, "--samples", "1"])["rows"][-1]
        samples = max(1, round(arguments.rays_per_pixel * 320 * 320 / pilot["rays"]))
        print(f"{picture.relative_to(ROOT)}: {samples} samples", file=sys.stderr)
        run(chapter, [*size, "--samples", str(samples), "--output", str(picture)])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, help="the record")
    parser.add_argument("--backend", default="compute", help="of all runs (default: compute)")
    parser.add_argument("--repetitions", type=int, default=8, help="runs of each case, with other seeds")
    parser.add_argument("--pictures", action="store_true", help="render docs/pictures as well")
    parser.add_argument("--rays-per-pixel", type=int, default=400, help="of the pictures")
    arguments = parser.parse_args()
    record = measure(arguments)
    name = re.sub(r"[^a-z0-9]+", "_", record["device"].split("(")[0].strip().lower())
    output = arguments.output or ROOT / "docs/records/chapters" / f"{name}.json"
    output.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    if arguments.pictures:
        render_pictures(arguments)


if __name__ == "__main__":
    main()
