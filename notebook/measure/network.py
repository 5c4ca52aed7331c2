"""How much of a network's gain chapter 16's filter has: Intel's Open Image Denoise, with emission apart and the same features.

    pip install mitsuba-oidn
    ./lab notebook network [--runs 4] [--backend compute --samples 256] [--output FILE.json]

Both filter the same samples. For each scene and number of samples the record has the squared errors, relative to that of the unfiltered
picture, of the filter and of the network.
"""
import tempfile
import time
from pathlib import Path

import numpy as np
from measure.filters import CHAPTER, REFERENCES
from measure.turns import options_of, rendered
from project import ROOT, UserError, show_progress, write_json
from references.exr import Exr
from references.images import read_reference, rel_mse, scene_file
from tables.sources import stamped

FEATURE_SAMPLES = 16  # as in the chapter


def denoised(color, albedo, normals):
    """The network's picture."""
    try:
        from mitsuba_oidn import denoise
    except ImportError:
        raise UserError("./lab notebook network needs Open Image Denoise: pip install mitsuba-oidn") from None
    images = np.maximum(color, 0), albedo, 2 * normals - 1
    color, albedo, normals = (np.ascontiguousarray(image, np.float32) for image in images)
    return np.asarray(denoise(color, albedo=albedo, normal=normals, hdr=True), float)


def main():
    options = options_of("network", __doc__, 4, 256, ROOT / "notebook/records/network/native.json")
    cases, started = [], time.monotonic()
    counts = [count for count in (4, 16, 64, 256, 1024) if count <= options.samples]
    steps = [(reference, count) for reference in REFERENCES for count in counts]
    with tempfile.TemporaryDirectory() as name:
        for step, (reference, count) in enumerate(steps, 1):
            truth = read_reference(ROOT / f"assets/references/{reference}.exr")
            height, width, _ = truth.mean.shape
            scene, length = reference.rsplit("_", 1)

            def picture(samples, seed, *more):
                """The picture, and the device that rendered it."""
                size = (f"--width={width}", f"--height={height}", f"--samples={samples}", f"--seed={seed}")
                report = rendered(CHAPTER, scene_file(scene), Path(name), *size, f"--backend={options.backend}", *more)
                return Exr(Path(name) / "picture.exr").rgb(), report["device"]

            errors = {"filter": [], "network": []}
            for seed in range(1, options.runs + 1):
                paths = f"--max-path-length={length}"
                raw, device = picture(count, seed, paths)
                filtered, _ = picture(count, seed, paths, "--filter=nl_means")
                emission, _ = picture(count, seed, "--max-path-length=0")
                albedo, normals = (picture(FEATURE_SAMPLES, seed, f"--view={view}")[0] for view in ("albedo", "normals"))
                of_network = denoised(raw - emission, albedo, normals) + emission
                unfiltered = rel_mse(raw, truth)
                errors["filter"].append(rel_mse(filtered, truth) / unfiltered)
                errors["network"].append(rel_mse(of_network, truth) / unfiltered)
            cases.append({"scene": scene, "samples": count, **errors})
            show_progress("network", step, len(steps), started)
    write_json(options.output, stamped({"device": device, "backend": options.backend, "cases": cases}))
