"""Renders one of our scenes with Mitsuba 3 and reports error against samples and seconds as a chapter does.

It has the command line of a chapter as far as `./lab report --peer mitsuba` needs it. The seconds of a row are those of
Mitsuba's render calls alone; first calls with a few samples, which are discarded, compile its kernels.
"""
import itertools
import operator
import time
from pathlib import Path

from references.mitsuba import MAX_BATCH_PATHS, dr, make_mitsuba_scene, mi, np, run_mitsuba  # isort: skip

from project import VARIANTS, Parser, write_json
from references.exr import rgb_channels, write_exr
from references.images import read_reference, rel_mse
from references.scenes import read_scene

STEPS = 3  # Rows stand at an eighth, a quarter, a half and all of the samples: small calls would slow it down.


class Render:
    """A mean of samples that grows call by call."""

    def __init__(self, scene, pixels, seed):
        self.scene, self.pixels, self.seed = scene, pixels, seed
        self.calls = self.samples = self.seconds = self.sum = 0
        for samples in (1, 3):  # powers of two have a kernel of their own
            self.call(samples)

    def call(self, samples):
        """One render call: its image and seconds."""
        self.calls += 1
        started = time.perf_counter()
        image = mi.render(self.scene, spp=samples, seed=(self.seed * 65536 + self.calls) % (1 << 32))
        if mi.variant() != "scalar_rgb":
            dr.eval(image)
            dr.sync_thread()
        return np.array(image, float), time.perf_counter() - started

    def add(self, samples):
        largest = max(1, MAX_BATCH_PATHS // self.pixels)
        while samples > 0:
            part = min(samples, largest)
            image, seconds = self.call(part)
            self.sum, self.seconds = self.sum + part * image, self.seconds + seconds
            self.samples, samples = self.samples + part, samples - part

    def row(self, reference):
        image = self.sum / self.samples
        return {"samples": self.samples, "seconds": self.seconds, "mean": image.mean(axis=(0, 1)).tolist(),
                "rel_mse": rel_mse(image, reference) if reference else None}


def render(options):
    """The report."""
    scene = read_scene(options.scene)
    mitsuba_scene, integrator = make_mitsuba_scene(scene, options.width, options.height, options.max_path_length,
                                                   own_normals=True)
    reference = read_reference(options.reference) if options.reference else None
    film = Render(mitsuba_scene, options.width * options.height, options.seed)
    counts = itertools.accumulate(itertools.repeat(2), operator.mul, initial=1)
    if options.samples:
        counts = sorted({max(1, options.samples >> step) for step in range(STEPS + 1)})
    rows = []
    for count in counts:
        film.add(count - film.samples)
        rows.append(film.row(reference))
        if options.time_limit and film.seconds >= options.time_limit:
            break
    if options.output:
        write_exr(options.output, rgb_channels(film.sum / film.samples), {})
    glossy = any(surface.material.specular.any() for surface in scene.surfaces)
    return {
        "scene_hash": scene.hash, "device": f"Mitsuba {mi.__version__}", "backend": integrator, "rows": rows,
        "note": "the Phong lobe is Python, which slows Mitsuba down" if glossy and mi.variant() == "scalar_rgb" else "",
    }


def main():
    parser = Parser("tools/peer", __doc__)
    parser.add_argument("scene", type=Path)
    parser.add_argument("--variant", choices=list(VARIANTS), required=True)
    for name in ("width", "height", "max-path-length", "seed"):
        parser.add_argument(f"--{name}", type=int, required=True)
    parser.add_argument("--samples", type=int, help="a pixel")
    parser.add_argument("--time-limit", type=float, help="without --samples: stop after 1, 2, 4, … of them and so many seconds")
    for name in ("reference", "output", "report"):
        parser.add_argument(f"--{name}", type=Path)
    options = parser.parse_args()

    def run():
        report = render(options)
        if options.report:
            write_json(options.report, report)

    run_mitsuba(options.variant, run)
