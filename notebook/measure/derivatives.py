"""What chapter 17's derivatives cost, against differences of two pictures: errors and seconds in the Cornell box.

    ./lab notebook derivatives [--runs 4] [--backend compute --samples 256] [--output FILE.json]

All take turns, with another seed in each run. The errors are those that the halves of the samples tell. The two pictures of a difference
have the same random numbers, or different ones. The seconds are those of the device, or with the backend native those of all processors
together.
"""
import tempfile
import time
from pathlib import Path

import numpy as np
from measure.turns import options_of, rendered
from project import ROOT, show_progress, write_json
from references.albedos import materials_of, write_scene
from references.exr import Exr
from references.images import scene_file
from tables.sources import stamped

CHAPTER, SIZE, STEP = "17_derivatives", 128, 0.03
NAMES = ("red", "green", "white")
WAYS = ("derivative", "difference", "other_numbers")


def main():
    options = options_of("derivatives", __doc__, 4, 64, ROOT / "notebook/records/derivatives/native.json")
    rows, started, box = [], time.monotonic(), scene_file("cornell_box")
    materials = materials_of(box)
    numbers_of = {material.name: number for number, material in enumerate(materials, 1)}
    albedos = {material.name: material.diffuse_albedo for material in materials}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def render(material, factor, seed, *others):
            """The report, the picture, and the difference of its halves."""
            settings = [f"--width={SIZE}", f"--height={SIZE}", f"--samples={options.samples}", f"--seed={seed}"]
            scene = write_scene(box, {material: factor * albedos[material]}, folder)
            report = rendered(CHAPTER, scene, folder, *settings, "--max-path-length=8", f"--backend={options.backend}", *others)
            picture = Exr(folder / "picture.exr")
            return report, picture.rgb(), picture.rgb("difference.")

        def measure(way, material, seed):
            """Report, mean, mean squared error and seconds of one way to the derivative."""
            if way == "derivative":
                report, mean, error = render(material, 1, seed, f"--derivative={numbers_of[material]}")
                return report, mean.mean(), (error**2).mean(), report["rows"][-1][options.seconds]
            other = seed if way == "difference" else seed + 1000
            report, more, more_error = render(material, np.exp(STEP), seed)
            second, less, less_error = render(material, np.exp(-STEP), other)
            error = (more_error - less_error) / (2 * STEP)
            seconds = sum(each["rows"][-1][options.seconds] for each in (report, second))
            return report, (more - less).mean() / (2 * STEP), (error**2).mean(), seconds

        for material in NAMES:
            found = {way: {"mean": [], "mse": [], "seconds": []} for way in WAYS}
            for run in range(options.runs):
                for way, numbers in found.items():
                    report, *measured = measure(way, material, 1 + run)
                    for key, value in zip(numbers, measured):
                        numbers[key].append(float(value))
                show_progress("derivatives", len(rows) * options.runs + run + 1, len(NAMES) * options.runs, started)
            rows.append({"material": material, **found})
    write_json(
        options.output,
        stamped({"device": report["device"], "backend": options.backend, "size": SIZE, "samples": options.samples, "rows": rows}),
    )
