"""What light paths gain: errors and seconds of chapters 14 and 15 in `glass`, with lamps of the same power and ever smaller sides.

    ./lab notebook light_paths [--runs 4] [--backend compute --samples 256] [--output FILE.json]

Both take turns, with another seed in each run. The errors are those that the halves of the samples tell, relative to a longer render of
chapter 15: of the whole picture, and of the pixels where the camera sees no glass. The seconds are those of the device, or with the
backend native those of all processors together.
"""
import json
import tempfile
import time
from pathlib import Path

import numpy as np
from measure.turns import options_of, rendered
from project import ROOT, read_json, show_progress, write_json
from references.exr import Exr
from references.images import Reference, read_rgb
from tables.sources import stamped

CHAPTERS = {"camera": "14_many_lights", "both": "15_light_paths"}
SIDES, SIZE, LONGER = (0.6, 0.2, 0.06, 0.02), 128, 8


def write_scene(side, folder):
    """`glass` with a lamp of this side, whose radiance keeps its power. Returns the scene's file."""
    meshes, whole = ROOT / "assets/meshes", 0.6
    room = (meshes / "room.obj").read_text().replace("0.3", f"{side / 2:g}").replace("room.mtl", "lamp.mtl")
    (folder / "lamp.obj").write_text(room)
    radiance = [float(value) * (whole / side) ** 2 for value in (13.8, 12.2, 9.8)]
    materials = (meshes / "room.mtl").read_text()
    (folder / "lamp.mtl").write_text(materials.replace("Ke 13.8 12.2 9.8", "Ke " + " ".join(map(str, radiance))))
    scene = read_json(ROOT / "assets/scenes/glass.json")
    for mesh in scene["meshes"]:
        mesh["file"] = "lamp.obj" if mesh["file"].endswith("room.obj") else str(meshes / Path(mesh["file"]).name)
        if "materials" in mesh:
            mesh["materials"] = str(meshes / Path(mesh["materials"]).name)
    (folder / "scene.json").write_text(json.dumps(scene))
    return folder / "scene.json"


def widened(mask):
    """A mask and the pixels around it: those on an edge see both sides."""
    around = np.pad(mask, 1)
    height, width = mask.shape
    return np.any([around[y : y + height, x : x + width] for y in range(3) for x in range(3)], axis=0)


def main():
    options = options_of("light_paths", __doc__, 4, 128, ROOT / "notebook/records/light_paths/native.json")
    rows, started = [], time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder, picture = Path(name), Path(name) / "picture.exr"

        def render(chapter, samples, seed, *others):
            size = [f"--width={SIZE}", f"--height={SIZE}"]
            numbers = [f"--samples={samples}", f"--seed={seed}"]
            return rendered(CHAPTERS[chapter], folder / "scene.json", folder, *size, *numbers, *others)

        for side in SIDES:
            write_scene(side, folder)
            render("both", 1, 1, "--view=albedo")
            sees_glass = widened(read_rgb(picture).max(axis=2) == 0)
            render("both", LONGER * options.samples, 1000, f"--backend={options.backend}")
            weights = Reference(read_rgb(picture), None, {}).weights
            found = {chapter: {"rel_mse": [], "rel_mse_of_matte": [], "seconds": []} for chapter in CHAPTERS}
            for run in range(options.runs):
                for chapter, numbers in found.items():
                    content = render(chapter, options.samples, 1 + run, f"--backend={options.backend}")
                    errors = (weights * Exr(picture).rgb("difference.") ** 2).mean(axis=2)
                    numbers["rel_mse"].append(float(errors.mean()))
                    numbers["rel_mse_of_matte"].append(float(errors[~sees_glass].mean()))
                    numbers["seconds"].append(content["rows"][-1][options.seconds])
                show_progress("light_paths", len(rows) * options.runs + run + 1, len(SIDES) * options.runs, started)
            rows.append({"side": side, "matte": float(np.mean(~sees_glass)), **found})
    write_json(
        options.output,
        stamped(
            {"device": content["device"], "backend": options.backend, "size": SIZE, "samples": options.samples, "rows": rows}
        ),
    )
