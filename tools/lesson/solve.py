"""Finds albedos of a scene from a picture of it, by the derivatives of chapter 17.

    ./lab solve cornell_box assets/references/cornell_box_6.exr red green

The picture is an EXR of the scene from its own camera, and the names are those of materials in the scene's .mtl files. All start with the
albedo 1/2. Each step renders the picture and the derivatives, and changes the albedos so that, by least squares over all pixels, the
derivatives explain the difference. Picture and derivatives have different random numbers, since the product of their noise would
otherwise not vanish on average.
"""
import tempfile
from pathlib import Path

import numpy as np
from project import CHAPTERS, Parser, UserError, add_device_options, failure_text, number, program_file, run_program
from references.albedos import materials_of, write_scene
from references.exr import Exr, read_attributes
from references.images import scene_file

CHAPTER = next((folder for folder in CHAPTERS.values() if folder.endswith("_derivatives")), None)
START = 0.5
LARGEST_STEP = 1.5  # of the logarithm of an albedo
LOW, HIGH = 1e-3, 1.0  # of an albedo


def read_picture(file):
    """The picture in an EXR: array [row, column, channel]."""
    try:
        picture = Exr(file).rgb()
    except (KeyError, ValueError) as error:
        raise UserError(f"{file}: cannot be read as an EXR: {error}") from None
    if not np.isfinite(picture).all():
        raise UserError(f"{file}: some pixels are infinite or not a number")
    return picture


class Solver:
    """A scene whose albedos change, in a folder of its own."""

    def __init__(self, scene, picture, names, options, folder):
        self.scene, self.names, self.options, self.folder = scene, names, options, folder
        self.picture = read_picture(picture)
        self.length = options.max_path_length or int(read_attributes(picture).get("max_path_length", 0))
        known = [material.name for material in materials_of(scene)]
        for name in names:
            if known.count(name) != 1:
                raise UserError(
                    f"{name}: {'several materials have' if name in known else 'no material has'} this name: {', '.join(known)}"
                )
        self.numbers = [1 + known.index(name) for name in names]

    def render(self, seed, material=None):
        """The picture, or its derivative with respect to the logarithm of the albedo of the material with this number."""
        options, file = self.options, self.folder / "picture.exr"
        height, width, _ = self.picture.shape
        command = [program_file(CHAPTER), self.folder / "scene.json", "--headless", "--quiet", "--output", file]
        command += [f"--width={width}", f"--height={height}", f"--samples={options.samples}", f"--seed={seed}"]
        command += [f"--backend={options.backend}"]
        command += ["--max-path-length", self.length] if self.length else []
        command += ["--device", options.device] if options.device else []
        process = run_program([*command, *(["--derivative", material] if material else [])])
        if process.returncode != 0:
            raise UserError(failure_text(process))
        return Exr(file).rgb()

    def step(self, albedos, turn):
        """The albedos after one step."""
        write_scene(self.scene, dict(zip(self.names, albedos)), self.folder)
        missing = self.picture - self.render(2 * turn)
        derivatives = np.stack([self.render(2 * turn + 1, each) for each in self.numbers], axis=-1)
        changed = albedos.copy()
        for channel in range(3):
            # All pixels weigh the same: weights from the picture would prefer those that its noise has made dark.
            wanted = missing[..., channel].ravel()
            change = np.linalg.lstsq(derivatives[..., channel, :].reshape(len(wanted), -1), wanted, rcond=None)[0]
            changed[:, channel] *= np.exp(np.clip(change, -LARGEST_STEP, LARGEST_STEP))
        return np.clip(changed, LOW, HIGH)


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
