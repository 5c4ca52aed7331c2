"""Finds albedos of a scene from a picture of it, by the derivatives of chapter 17.

    ./lab solve cornell_box assets/references/cornell_box_6.exr red green

The picture is an EXR of the scene from its own camera, and the names are those of materials in the scene's .mtl files. All start with the
albedo 1/2. Each step renders the picture and the derivatives, and changes the albedos so that, by least squares over all pixels, the
derivatives explain the difference. Picture and derivatives have different random numbers, since the product of their noise would
otherwise not vanish on average.
"""
import json
import re
import tempfile
from pathlib import Path

import numpy as np
from project import (
    CHAPTERS,
    Parser,
    UserError,
    add_device_options,
    failure_text,
    number,
    program_file,
    read_json,
    run_program,
    text_of,
)
from references.exr import Exr, read_attributes
from references.images import scene_file

CHAPTER = next((folder for folder in CHAPTERS.values() if folder.endswith("_derivatives")), None)
START = 0.5
LARGEST_STEP = 1.5  # of the logarithm of an albedo
LOW, HIGH = 1e-3, 1.0  # of an albedo


def absolute(value, folder):
    """A value of a scene file whose names of files do not depend on where it lies."""
    if isinstance(value, dict):
        return {key: absolute(each, folder) for key, each in value.items()}
    if isinstance(value, list):
        return [absolute(each, folder) for each in value]
    return str((folder / value).resolve()) if isinstance(value, str) and (folder / value).is_file() else value


def material_file(mesh):
    """The .mtl file of an entry of a scene's meshes."""
    if "materials" in mesh:
        return Path(mesh["materials"])
    library = re.search(r"^mtllib +(.+?)\s*$", text_of(Path(mesh["file"])), re.MULTILINE)
    if not library:
        raise UserError(f"{mesh['file']}: has no mtllib, so there is no albedo to find")
    return Path(mesh["file"]).with_name(library[1])


def statements(text):
    """Material -> the text behind its newmtl."""
    parts = re.split(r"^newmtl +(.+?)\s*$", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


def is_glass(text):
    """Whether what an .mtl file says of a material makes it a dielectric."""
    opacity = re.search(r"^\s*d +(\S+)", text, re.MULTILINE)
    transparency = re.search(r"^\s*Tr +(\S+)", text, re.MULTILINE)
    return float(opacity[1]) < 1 if opacity else float(transparency[1]) > 0 if transparency else False


def names_in_order(meshes):
    """The names of all materials in the order of --derivative: that in which the faces of a mesh use them, glass after all others."""
    names, seen = [], set()
    for mesh in meshes:
        file = material_file(mesh)
        if (mesh["file"], file) in seen:
            continue
        seen.add((mesh["file"], file))
        said, used, name = statements(text_of(file)), {}, None
        for word, *rest in (line.split(maxsplit=1) for line in text_of(Path(mesh["file"])).splitlines() if line.strip()):
            if word == "usemtl":
                name = rest[0].strip()
            elif word == "f":
                used[name] = is_glass(said.get(name, ""))
        names += sorted(used, key=used.get)
    return names


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
        self.scene, self.names, self.options, self.folder = absolute(read_json(scene), scene.parent), names, options, folder
        self.picture = read_picture(picture)
        self.length = options.max_path_length or int(read_attributes(picture).get("max_path_length", 0))
        known = names_in_order(self.scene["meshes"])
        for name in names:
            if known.count(name) != 1:
                raise UserError(
                    f"{name}: {'several materials have' if name in known else 'no material has'} this name: {', '.join(known)}"
                )
            if not any(
                re.search(r"^\s*Kd ", statements(text_of(material_file(mesh))).get(name, ""), re.MULTILINE)
                for mesh in self.scene["meshes"]
            ):
                raise UserError(f"{name}: has no Kd in its .mtl file, so there is no albedo to find")
        self.numbers = [1 + known.index(name) for name in names]

    def write(self, albedos):
        """Writes the scene with these albedos, an array [material, channel]."""
        meshes = []
        for index, mesh in enumerate(self.scene["meshes"]):
            file = material_file(mesh)
            text = re.sub(
                r"^(\s*map_\w+ +)(\S+)", lambda map: f"{map[1]}{file.parent / map[2]}", text_of(file), flags=re.MULTILINE
            )
            for name, albedo in zip(self.names, albedos):
                found = " ".join(f"{value:.9g}" for value in albedo)
                text = re.sub(
                    rf"^(newmtl +{re.escape(name)}\s*\n(?:(?!newmtl).*\n)*?\s*Kd ).*", rf"\g<1>{found}", text, flags=re.MULTILINE
                )
            (self.folder / f"{index}.mtl").write_text(text, encoding="utf-8")
            meshes.append(mesh | {"materials": f"{index}.mtl"})
        (self.folder / "scene.json").write_text(json.dumps(self.scene | {"meshes": meshes}), encoding="utf-8")

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
        self.write(albedos)
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
