"""What chapter 16's filters gain: errors and seconds of filtered and unfiltered pictures against the number of samples.

    ./lab notebook filters [--runs 4] [--backend compute --samples 1024] [--output FILE.json]

The scenes have references of another renderer. All take turns, with another seed in each run. The seconds include the filter and what
else it renders; they are those of the device, or with the backend native those of all processors together.
"""
import tempfile
import time
from pathlib import Path

from measure.turns import options_of, rendered
from project import ROOT, show_progress, write_json
from references.exr import Exr
from references.images import scene_file
from tables.sources import stamped

CHAPTER = "16_denoising"
REFERENCES = ("cornell_box_6", "textured_4", "glass_8", "lamps_5", "smoke_8")
FILTERS = ("none", "bilateral", "a_trous", "nl_means")


def main():
    options = options_of("filters", __doc__, 4, 1024, ROOT / "notebook/records/filters/native.json")
    cases, started = [], time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        for reference in REFERENCES:
            file = ROOT / f"assets/references/{reference}.exr"
            height, width, _ = Exr(file).rgb().shape
            scene, length = reference.rsplit("_", 1)
            runs = {each: [] for each in FILTERS}
            for run in range(options.runs):
                for each in FILTERS:
                    report = rendered(
                        CHAPTER,
                        scene_file(scene),
                        Path(name),
                        *(f"--width={width}", f"--height={height}", f"--samples={options.samples}", f"--seed={1 + run}"),
                        *(f"--max-path-length={length}", f"--backend={options.backend}"),
                        *(f"--filter={each}", f"--reference={file}"),
                    )
                    keys = ("samples", "rel_mse", options.seconds)
                    runs[each].append([[row[key] for key in keys] for row in report["rows"] if row["samples"] >= 4])
                show_progress("filters", len(cases) * options.runs + run + 1, len(REFERENCES) * options.runs, started)
            cases.append({"scene": scene, **runs})
    write_json(options.output, stamped({"device": report["device"], "backend": options.backend, "cases": cases}))
