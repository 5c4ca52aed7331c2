"""Finds albedos of a scene from a picture of it, by the derivatives of chapter 17.

    ./lab solve cornell_box assets/references/cornell_box_6.exr red green

The picture is an EXR of the scene from its own camera, and the names are those of materials in the scene's .mtl files. All start with the
albedo 1/2. Each step renders the picture and the derivatives, and changes the albedos so that, by least squares over all pixels, the
derivatives explain the difference. Picture and derivatives have different random numbers, since the product of their noise would
otherwise not vanish on average. The last line compares the error that remains, the root of the mean of relative squares, with that of
noise alone: of the rendered picture, and of the other one if its file tells it.
"""
import re
import sys
import tempfile
from pathlib import Path

import numpy as np
from project import CHAPTERS, Parser, UserError, add_device_options, failure_text, number, program_file, run_program
from references.albedos import materials_of, write_scene
from references.exr import Exr
from references.images import Reference, scene_file

CHAPTER = next((folder for folder in CHAPTERS.values() if folder.endswith("_derivatives")), None)
START = 0.5
LARGEST_STEP = 1.5  # of the logarithm of an albedo
LOW, HIGH = 1e-3, 1.0  # of an albedo
NOTEWORTHY = 1.2  # error that remains, in multiples of what noise alone leaves: 0.9 to 1.1 where the scene fits


def variance(file):
    """Of the pixels of an Exr, where it tells: array [row, column, channel]."""
    if "variance.R" in file.channels:
        return file.rgb("variance.")
    if "difference.R" in file.channels:  # of halves; of an odd number of samples, one half has another sample
        samples = int(file.attributes["samples"])
        return file.rgb("difference.") ** 2 - samples % 2 * (file.rgb() / samples) ** 2
    return np.zeros_like(file.rgb())


def path_length(attributes):
    """The maximal path length that a reference or a chapter's picture states, or None."""
    stated = re.search(r"^\d+|(?<=--max-path-length )\d+", attributes.get("max_path_length") or attributes.get("settings", ""))
    return stated and int(stated[0])


def read_picture(path):
    """The picture in an EXR."""
    try:
        file = Exr(path)
        picture = Reference(file.rgb(), variance(file), file.attributes)
    except (KeyError, ValueError) as error:
        raise UserError(f"{path}: cannot be read as an EXR: {error}") from None
    if not np.isfinite(picture.mean).all():
        raise UserError(f"{path}: some pixels are infinite or not a number")
    if shows := file.attributes.get("shows"):
        raise UserError(f"{path}: shows {shows}: give a picture of the scene's light")
    return picture


class Solver:
    """A scene whose albedos change, in a folder of its own."""

    def __init__(self, scene, picture, names, options, folder):
        self.scene, self.names, self.options, self.folder = scene, names, options, folder
        self.picture = read_picture(picture)
        self.length = options.max_path_length or path_length(self.picture.attributes)
        known = [material.name for material in materials_of(scene)]
        for name in names:
            if names.count(name) > 1:
                raise UserError(f"{name}: is named twice")
            if known.count(name) != 1:
                raise UserError(
                    f"{name}: {'several materials have' if name in known else 'no material has'} this name: {', '.join(known)}"
                )
        self.numbers = [1 + known.index(name) for name in names]

    def render(self, seed, samples, material=None):
        """An Exr of the picture, or of its derivative with respect to the logarithm of the albedo of the material with this number."""
        options, file = self.options, self.folder / "picture.exr"
        height, width, _ = self.picture.mean.shape
        command = [program_file(CHAPTER), self.folder / "scene.json", "--headless", "--quiet", "--output", file]
        command += [f"--width={width}", f"--height={height}", f"--samples={samples}", f"--seed={seed}"]
        command += [f"--backend={options.backend}"]
        command += ["--max-path-length", self.length] if self.length else []
        command += ["--device", options.device] if options.device else []
        process = run_program([*command, *(["--derivative", material] if material else [])])
        if process.returncode != 0:
            raise UserError(failure_text(process))
        return Exr(file)

    def step(self, albedos, turn):
        """The albedos after one step."""
        write_scene(self.scene, dict(zip(self.names, albedos)), self.folder)
        missing = self.picture.mean - self.render(2 * turn, self.options.samples).rgb()
        derivatives = np.stack([self.render(2 * turn + 1, self.options.samples, each).rgb() for each in self.numbers], axis=-1)
        changed = albedos.copy()
        for channel in range(3):
            # All pixels weigh the same: weights from the picture would prefer those that its noise has made dark.
            wanted = missing[..., channel].ravel()
            change = np.linalg.lstsq(derivatives[..., channel, :].reshape(len(wanted), -1), wanted, rcond=None)[0]
            changed[:, channel] *= np.exp(np.clip(change, -LARGEST_STEP, LARGEST_STEP))
        return np.clip(changed, LOW, HIGH)

    def errors(self, albedos, turn):
        """The relative error that remains with these albedos, and that of the noise in both pictures alone."""
        write_scene(self.scene, dict(zip(self.names, albedos)), self.folder)
        rendered = self.render(2 * turn, self.options.samples + self.options.samples % 2)  # a single one tells no noise
        pixels = rendered.rgb()
        # Relative to the larger of two values: noise that makes a pixel of the picture dark would otherwise make its error large.
        larger = np.maximum(pixels, self.picture.mean)
        weights = 1 / np.maximum(larger**2 + 0.01 * larger.mean() ** 2, 1e-30)
        squares = (pixels - self.picture.mean) ** 2, self.picture.variance + variance(rendered)
        return [float((weights * square).mean()) ** 0.5 for square in squares]


def main():
    parser = Parser("./lab solve", __doc__)
    parser.add_argument("scene", help="name or file of a scene")
    parser.add_argument("picture", type=Path, help="an EXR of it")
    parser.add_argument("material", nargs="+", help="names of materials whose albedos are to be found")
    parser.add_argument("--steps", type=number(int, 1), default=5, help="default: 5")
    parser.add_argument("--samples", type=number(int, 1), default=64, help="per pixel of each picture; default: 64")
    parser.add_argument("--max-path-length", type=number(int, 1), help="default: that of the picture, or the scene's")
    add_device_options(parser)
    options = parser.parse_args()
    if not CHAPTER:
        raise UserError("./lab solve needs chapter 17, derivatives, which is not in this tree")
    scene = scene_file(options.scene)
    for file in (scene, options.picture):
        if not file.is_file():
            raise UserError(f"{file}: there is no such file")
    if scene.suffix != ".json":
        raise UserError(f"{scene}: is no .json: write a scene file that names it, see docs/scenes.md")
    with tempfile.TemporaryDirectory() as folder:
        solver = Solver(scene, options.picture, options.material, options, Path(folder))
        albedos = np.full((len(options.material), 3), START)
        for turn in range(1, options.steps + 1):
            albedos = solver.step(albedos, turn)
            found = "   ".join(
                f"{name} {' '.join(f'{v:.4f}' for v in albedo)}" for name, albedo in zip(options.material, albedos)
            )
            print(f"step {turn}   {found}", flush=True)
        error, noise = solver.errors(albedos, options.steps + 1)
        print(f"error {100 * error:.3g} %; noise alone would leave {100 * noise:.3g} %")
        if error > NOTEWORTHY * noise:
            print(
                "note: these albedos do not explain the picture: try more --steps, or look for what else differs", file=sys.stderr
            )
        for name, albedo in zip(options.material, albedos):
            for bound in (LOW, HIGH):
                if (albedo == bound).any():
                    print(f"note: {name}: its albedo ended at the bound {bound:g}", file=sys.stderr)
