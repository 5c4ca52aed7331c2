"""Renders reference images of our scenes with Mitsuba 3, a renderer that shares no code with ours.

    ./lab reference SCENE --output FILE.exr   renders one scene, possibly your own
    ./lab reference --all                     re-renders those in assets/references whose scenes have changed

A reference is an EXR file with the mean of all samples in R, G and B, the variance of that mean, estimated from
independent batches, in variance.R, variance.G and variance.B, and its settings as attributes. Path lengths
count as in the chapters: at most m bounces are Mitsuba's max_depth m + 1. There is no Russian roulette. Where there are
media, their boundaries and glass must be closed, and lie apart from each other and from all surfaces.

Mitsuba is only needed to make references (`pip install mitsuba`; made and tested with version 3.9.1). Its variant
scalar_rgb runs everywhere, but is slow where vertex normals are interpolated or the Phong lobe is used, as that is
Python here; llvm_ad_rgb compiles it for the CPU (LLVM 19 or newer, DRJIT_LIBLLVM_PATH names its library) and
cuda_ad_rgb for NVIDIA's GPUs.
"""
import math
import signal
import time
from pathlib import Path

from references.mitsuba_scene import MAX_BATCH_PATHS, make_mitsuba_scene, mi, np, run_mitsuba  # isort: skip

from project import ROOT, VARIANTS, Parser, UserError, number, show_progress
from references.exr import read_attributes, rgb_channels, write_exr
from references.images import FOLDERS
from references.scenes import read_scene

GOES_ON = True
BATCHES = 64  # for the variance of the mean: accurate to 18 %
MIN_BATCHES = 32  # in an interrupted render


def render_batches(scene, name, batches, samples_per_batch, seed):
    """Mean of the batches, variance of the mean, and the number of batches, which is lower after Ctrl-C."""
    interrupts = []
    default_handler = signal.signal(signal.SIGINT, lambda *_: interrupts.append("Ctrl-C"))
    total = squares = done = 0
    started = time.monotonic()
    while done < batches and not interrupts:
        # Mitsuba uses a separate sequence of random numbers for each seed and pixel.
        image = mi.render(scene, spp=samples_per_batch, seed=(seed * batches + done) % (1 << 32))
        image = np.array(image, float)
        total, squares, done = total + image, squares + image * image, done + 1
        show_progress(name, done, batches, started)
    signal.signal(signal.SIGINT, default_handler)
    if done < MIN_BATCHES:
        raise UserError(f"interrupted after {done} of {batches} batches: too early for an image")
    mean = total / done
    return mean, np.maximum(squares / done - mean * mean, 0) / (done - 1), done


def make_reference(scene_file, output, width, height, max_path_length, samples, seed, keep=False):
    """Renders a scene, unless `keep` is set and the file is up to date. None means the scene's own setting."""
    scene = read_scene(scene_file)
    if scene.light_probe and output.resolve() == scene.light_probe.resolve():
        raise UserError(f"{output}: would replace the scene's light probe: choose another name")
    width, height = width or scene.width, height or scene.height
    max_path_length = scene.max_path_length if max_path_length is None else max_path_length
    batches = max(BATCHES, math.ceil(samples * width * height / MAX_BATCH_PATHS))
    samples_per_batch = math.ceil(samples / batches)
    attributes = {
        "scene": Path(scene_file).name,
        "scene_hash": scene.hash,
        "width": width,
        "height": height,
        "max_path_length": max_path_length,
        "seed": seed,
        "samples": batches * samples_per_batch,
    }
    if (
        keep
        and output.exists()
        and {key: str(value) for key, value in attributes.items()}.items() <= read_attributes(output).items()
    ):
        print(f"{output}: is up to date")
        return
    mitsuba_scene, integrator = make_mitsuba_scene(scene, width, height, max_path_length)
    mean, variance, done = render_batches(mitsuba_scene, output.stem, batches, samples_per_batch, seed)
    if not np.isfinite(mean).all():
        raise UserError(f"{scene_file}: Mitsuba's image has pixels that are infinite or not a number")
    attributes |= {
        "samples": done * samples_per_batch,
        "batches": done,
        "renderer": "Mitsuba",
        "version": mi.__version__,
        "variant": mi.variant(),
        "integrator": integrator,
    }
    write_exr(output, rgb_channels(mean) | rgb_channels(variance, "variance."), attributes)
    error = math.sqrt(variance.mean(axis=2).sum()) / mean.mean() / (width * height) if mean.any() else 0
    print(f"{output}: {done * samples_per_batch} samples a pixel, the image's mean is known to {100 * error:.2g} %")
    if done < batches:
        raise KeyboardInterrupt


def main():
    parser = Parser("./lab reference", "Renders reference images with Mitsuba 3.")
    positive = number(int, 1)
    parser.add_argument("scene", nargs="?", type=Path, help="a .json or .obj file")
    parser.add_argument(
        "--all", action="store_true", help="those in assets/references whose scenes have changed; only --seed and --variant count"
    )
    parser.add_argument("--output", type=Path, metavar="FILE.exr", help="default: output/references/SCENE.exr")
    parser.add_argument("--width", type=positive, help="default: as the scene says, else 512")
    parser.add_argument("--height", type=positive, help="default: as the scene says, else 512")
    parser.add_argument("--max-path-length", type=number(int, 0), help="default: as the scene says, else 8")
    parser.add_argument(
        "--samples", type=positive, default=1024, help="a pixel, rounded up to a multiple of 64 or more batches; default: 1024"
    )
    parser.add_argument("--seed", type=number(int, 0), default=1, help="default: 1")
    parser.add_argument("--variant", choices=list(VARIANTS), default="scalar_rgb", help="of Mitsuba; default: scalar_rgb")
    options = parser.parse_args()
    if options.all == (options.scene is not None):
        parser.error("either a scene or --all is needed")
    if options.output and options.output.suffix != ".exr":
        parser.error(f"--output {options.output}: must end in .exr")
    run_mitsuba(options.variant, lambda: make(options))


def make(options):
    if not options.all:
        output = options.output or FOLDERS[1] / f"{options.scene.stem}.exr"
        make_reference(
            options.scene, output, options.width, options.height, options.max_path_length, options.samples, options.seed
        )
        return
    for file in sorted(FOLDERS[0].glob("*.exr")):
        stated = read_attributes(file)
        size = (int(stated[key]) for key in ("width", "height", "max_path_length", "samples"))
        make_reference(ROOT / "assets/scenes" / stated["scene"], file, *size, options.seed, keep=True)
