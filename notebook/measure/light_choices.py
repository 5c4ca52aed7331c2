"""What the tree over emissive triangles gains: errors and seconds of chapter 14 with each way to choose a lamp.

    ./lab notebook light_choices [--runs 4] [--backend compute --samples 256] [--output FILE.json]

All take turns, with another seed in each run. The errors are those that the halves of the samples tell. The seconds are those of the
device, or with the backend native those of all processors together.
"""
import tempfile
import time
from pathlib import Path

from measure.turns import options_of, rendered
from project import ROOT, show_progress, write_json
from tables.sources import stamped

CHAPTER, CHOICES = "14_many_lights", ("tree", "power", "uniform")
SCENES, SIZE = ("lamps", "city", "heart_light", "cornell_box"), 256


def main():
    options = options_of("light_choices", __doc__, 4, 32, ROOT / "notebook/records/lights/native.json")
    rows, started = [], time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        for scene in SCENES:
            found = {choice: {"rel_mse": [], "seconds": []} for choice in CHOICES}
            for run in range(options.runs):
                for choice, numbers in found.items():
                    content = rendered(
                        CHAPTER,
                        scene,
                        Path(folder),
                        f"--backend={options.backend}",
                        f"--width={SIZE}",
                        f"--height={SIZE}",
                        f"--samples={options.samples}",
                        f"--seed={1 + run}",
                        f"--light-choice={choice}",
                    )
                    numbers["rel_mse"].append(content["rows"][-1]["rel_mse"])
                    numbers["seconds"].append(content["rows"][-1][options.seconds])
                show_progress("light_choices", len(rows) * options.runs + run + 1, len(SCENES) * options.runs, started)
            rows.append({"scene": scene, **found})
    write_json(
        options.output,
        stamped(
            {"device": content["device"], "backend": options.backend, "size": SIZE, "samples": options.samples, "rows": rows}
        ),
    )
