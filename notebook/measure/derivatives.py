"""What chapter 17's derivatives cost, against differences of two pictures: errors and seconds in the Cornell box.

    ./lab notebook derivatives [--runs 4] [--backend compute --samples 256] [--output FILE.json]

All take turns, with another seed in each run. The errors are those that the halves of the samples tell. The two pictures of a difference
have the same random numbers, or different ones. The seconds are those of the device, or with the backend native those of all processors
together.
"""
import json
import re
import tempfile
import time
from pathlib import Path

import numpy as np
from measure.turns import options_of, rendered
from project import ROOT, read_json, show_progress, write_json
from references.exr import Exr
from tables.sources import stamped

CHAPTER, SIZE, STEP = "17_derivatives", 128, 0.03
MATERIALS = {"red": 2, "green": 3, "white": 1}
WAYS = ("derivative", "difference", "other_numbers")


def write_scene(material, factor, folder):
    """The Cornell box with all of a material's albedo times this factor. Returns the scene's file."""
    meshes = ROOT / "assets/meshes"
    text = (meshes / "cornell_box.mtl").read_text()

    def scaled(match):
        return match[1] + " ".join(f"{factor * float(value):.9g}" for value in match[2].split())

    (folder / "box.mtl").write_text(re.sub(rf"(newmtl {material}\nKd )(.*)", scaled, text))
    (folder / "box.obj").write_text((meshes / "cornell_box.obj").read_text().replace("cornell_box.mtl", "box.mtl"))
    scene = read_json(ROOT / "assets/scenes/cornell_box.json")
    scene["meshes"] = [{"file": "box.obj"}]
    (folder / "scene.json").write_text(json.dumps(scene))
    return folder / "scene.json"


def main():
    options = options_of("derivatives", __doc__, 4, 64, ROOT / "notebook/records/derivatives/native.json")
    rows, started = [], time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        def render(material, factor, seed, *others):
            """The report, the picture, and the difference of its halves."""
            settings = [f"--width={SIZE}", f"--height={SIZE}", f"--samples={options.samples}", f"--seed={seed}"]
            scene = write_scene(material, factor, folder)
            report = rendered(CHAPTER, scene, folder, *settings, "--max-path-length=8", f"--backend={options.backend}", *others)
            picture = Exr(folder / "picture.exr")
            return report, picture.rgb(), picture.rgb("difference.")

        def measure(way, material, seed):
            """Report, mean, mean squared error and seconds of one way to the derivative."""
            if way == "derivative":
                report, mean, error = render(material, 1, seed, f"--derivative={MATERIALS[material]}")
                return report, mean.mean(), (error**2).mean(), report["rows"][-1][options.seconds]
            other = seed if way == "difference" else seed + 1000
            report, more, more_error = render(material, np.exp(STEP), seed)
            second, less, less_error = render(material, np.exp(-STEP), other)
            error = (more_error - less_error) / (2 * STEP)
            seconds = sum(each["rows"][-1][options.seconds] for each in (report, second))
            return report, (more - less).mean() / (2 * STEP), (error**2).mean(), seconds

        for material in MATERIALS:
            found = {way: {"mean": [], "mse": [], "seconds": []} for way in WAYS}
            for run in range(options.runs):
                for way, numbers in found.items():
                    report, *measured = measure(way, material, 1 + run)
                    for key, value in zip(numbers, measured):
                        numbers[key].append(float(value))
                show_progress("derivatives", len(rows) * options.runs + run + 1, len(MATERIALS) * options.runs, started)
            rows.append({"material": material, **found})
    write_json(
        options.output,
        stamped({"device": report["device"], "backend": options.backend, "size": SIZE, "samples": options.samples, "rows": rows}),
    )
