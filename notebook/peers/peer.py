"""Renders one of our scenes with Mitsuba 3 and reports error against samples and seconds as a chapter does.

Takes a chapter's command line, as far as `./lab notebook report --peer mitsuba` needs it. Seconds are those of Mitsuba's render calls
alone; kernels are compiled before.
"""
import itertools
import math
import time
from pathlib import Path

from references.mitsuba_scene import MAX_BATCH_PATHS, dr, make_mitsuba_scene, mi, np, run_mitsuba  # isort: skip

from peers.cases import GPU_VARIANT, SAMPLERS
from project import VARIANTS, Parser, write_json
from references.exr import rgb_channels, write_exr
from references.images import read_reference, rel_mse
from references.scenes import read_scene

CALLS = 8  # with independent samples, for a curve. Other samplers stratify the samples within a call, so fewer calls err less.
GPU_BATCH_PATHS = 1 << 26  # instead of MAX_BATCH_PATHS: they take about 4 GiB
GROWTH = 8  # factor between the samples of calls, until the time is up


class Render:
    """A running mean of samples."""

    def __init__(self, scene, pixels, seed):
        self.scene, self.seed = scene, seed
        self.largest = max(1, (GPU_BATCH_PATHS if mi.variant() == GPU_VARIANT else MAX_BATCH_PATHS) // pixels)
        self.compiled = set()  # numbers of samples
        self.calls = self.samples = self.seconds = self.cpu_seconds = self.sum = self.discarded_seconds = 0

    def call(self, samples):
        """One render call: its image, and its seconds of wall time and of all threads."""
        self.calls += 1
        started, cpu_started = time.perf_counter(), time.process_time()
        image = mi.render(self.scene, spp=samples, seed=(self.seed * 65536 + self.calls) % (1 << 32))
        if mi.variant() != "scalar_rgb":
            dr.eval(image)
            dr.sync_thread()
        return np.array(image, float), time.perf_counter() - started, time.process_time() - cpu_started

    def add(self, samples):
        """Renders about this many samples: most samplers round the number up, and need a kernel for each number. A first call,
        which is discarded, compiles it."""
        sampler = self.scene.sensors()[0].sampler()
        sampler.set_sample_count(min(samples, self.largest))
        count = sampler.sample_count()
        is_first = count not in self.compiled
        if is_first:
            self.call(count)
            self.compiled.add(count)
        image, seconds, cpu_seconds = self.call(count)
        self.discarded_seconds += is_first * seconds  # of rendering alone: compiling is part of start-up
        self.sum, self.samples = self.sum + count * image, self.samples + count
        self.seconds, self.cpu_seconds = self.seconds + seconds, self.cpu_seconds + cpu_seconds

    def row(self, reference):
        image = self.sum / self.samples
        return {"samples": self.samples, "seconds": self.seconds, "cpu_seconds": self.cpu_seconds, "mean": image.mean(axis=(0, 1)).tolist(),
                "rel_mse": rel_mse(image, reference) if reference else None}


def render(options):
    """The report."""
    scene = read_scene(options.scene)
    mitsuba_scene, integrator = make_mitsuba_scene(scene, options.width, options.height, options.max_path_length,
                                                   own_normals=True, sampler=options.sampler)
    reference = read_reference(options.reference) if options.reference else None
    film = Render(mitsuba_scene, options.width * options.height, options.seed)
    if options.samples:
        calls = max(CALLS if options.sampler == SAMPLERS[0] else 1, math.ceil(options.samples / film.largest))
        parts = itertools.repeat(math.ceil(options.samples / calls))
    else:
        parts = (GROWTH**power for power in itertools.count())
    rows = []
    for number, part in enumerate(parts, 1):
        film.add(part)
        is_last = film.samples >= options.samples if options.samples else film.seconds >= options.time_limit
        if is_last or number.bit_count() == 1:  # rows after 1, 2, 4, … calls
            rows.append(film.row(reference))
        if is_last:
            break
    if options.output:
        write_exr(options.output, rgb_channels(film.sum / film.samples), {})
    glossy = any(surface.material.specular.any() for surface in scene.surfaces)
    return {
        "scene_hash": scene.hash, "device": f"Mitsuba {mi.__version__}", "backend": integrator, "rows": rows,
        "discarded_seconds": film.discarded_seconds,
        "note": "the Phong lobe is Python, which slows Mitsuba down" if glossy and mi.variant() == "scalar_rgb" else "",
    }


def main():
    parser = Parser("./lab notebook peer", __doc__)
    parser.add_argument("scene", type=Path)
    parser.add_argument("--variant", choices=list(VARIANTS), required=True)
    for name in ("width", "height", "max-path-length", "seed"):
        parser.add_argument(f"--{name}", type=int, required=True)
    parser.add_argument("--sampler", choices=SAMPLERS, default=SAMPLERS[0], help="of Mitsuba; default: independent")
    length = parser.add_mutually_exclusive_group(required=True)
    length.add_argument("--samples", type=int, help="a pixel, or as many more as the sampler needs")
    length.add_argument("--time-limit", type=float, help="stop after so many seconds of rendering")
    for name in ("reference", "output", "report"):
        parser.add_argument(f"--{name}", type=Path)
    options = parser.parse_args()

    def run():
        report = render(options)
        if options.report:
            write_json(options.report, report)

    run_mitsuba(options.variant, run)
