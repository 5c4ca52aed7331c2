"""Figures whose colours are signs: red where a picture becomes brighter, blue where it becomes darker, white where it stays."""
import functools
import shutil

import numpy as np
from project import ROOT
from report.plots import LUMINANCE, difference_colours, encode_srgb, relative_difference, sheet

FILTERS = ("bilateral", "a_trous", "nl_means")
SEEDS = 64
LARGEST_BIAS = 0.15  # of the picture's mean: saturated
STEP = 0.02  # of the lamp to each side
SATURATED = 0.02  # part of the pixels of a derivative


# ---------------------------------------------------------------------------------------------- bias of filters
def renders_of_bias(Render, chapter, scene):
    """The same samples unfiltered and with each filter, many times."""
    return [
        Render(f"{name}_{seed}", chapter, scene, 240, ("--samples", 16, "--seed", seed, "--filter", name))
        for name in ("none", *FILTERS)
        for seed in range(1, SEEDS + 1)
    ]


def bias(folder, renders):
    """The mean of filtered minus unfiltered pictures: no reference is needed."""
    means = {name: np.mean([r.image for r in renders if r.options[-1] == name], axis=0) for name in ("none", *FILTERS)}
    tiles = [
        (f"bias of {name}", difference_colours(relative_difference(means[name], means["none"]), LARGEST_BIAS)) for name in FILTERS
    ]
    sheet(folder / "bias.jpg", [tiles])


# ---------------------------------------------------------------------------------------------- lamps that move
@functools.cache
def moved_scene(scene, shift):
    """A scene file: the scene of a single mesh, whose lamp is farther along x."""
    folder = ROOT / f"output/figures/moved_lamp_{shift:g}"
    folder.mkdir(parents=True, exist_ok=True)
    meshes = ROOT / "assets/meshes"
    lines = (meshes / f"{scene}.obj").read_text(encoding="utf-8").splitlines()
    corners = {int(word) for line in lines[lines.index("usemtl light") + 1 :][:2] for word in line.split()[1:]}
    vertices = [i for i, line in enumerate(lines) if line.startswith("v ")]
    for corner in corners:
        x, y, z = map(float, lines[vertices[corner - 1]].split()[1:])
        lines[vertices[corner - 1]] = f"v {x + shift:.9g} {y:.9g} {z:.9g}"
    (folder / f"{scene}.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    shutil.copy(meshes / f"{scene}.mtl", folder)
    text = (ROOT / f"assets/scenes/{scene}.json").read_text(encoding="utf-8")
    (folder / "scene.json").write_text(text.replace("../meshes/", ""), encoding="utf-8")
    return folder / "scene.json"


def renders_of_moved_lamps(Render, chapter, scene):
    """The direct light, its derivative, and pictures whose lamp is moved to either side."""
    options = ("--only-path-length", 1, "--samples", 4096)
    return [
        Render("picture", chapter, scene, 240, options),
        Render("derivative", chapter, scene, 240, (*options, "--move-lamps", "x")),
        *(Render(f"moved_{step:g}", chapter, moved_scene(scene, step), 240, options) for step in (STEP, -STEP)),
    ]


def moved_lamps(folder, renders):
    picture, derivative, after, before = (render.image for render in renders)
    difference = (after - before) / (2 * STEP)
    full = np.quantile(np.abs(difference @ LUMINANCE), 1 - SATURATED)
    tiles = [
        (label, difference_colours(values @ LUMINANCE, full))
        for label, values in (
            ("--move-lamps x", derivative),
            ("difference of two pictures", difference),
            ("the first minus the second", derivative - difference),
        )
    ]
    sheet(folder / "moved_lamps.jpg", [[("direct light", encode_srgb(picture)), *tiles]])
