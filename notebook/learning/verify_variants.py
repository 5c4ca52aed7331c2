"""Compares each estimator in notebook/variants with its chapter's own: images must agree, noise and rays stay near. Images and their
tiles of 8 x 8 pixels are compared by z = difference / standard error over the seeds; |z| above 4 is rare by chance: see
whether it is there with another --first-seed, too."""
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from check.expected import DESCRIPTIONS
from check.grading import SCENES
from check.submission import Submission
from course.mistakes import own_shader
from learning.planting import variants
from project import CHAPTERS, Parser, number, program_file, read_json, run_program, show_progress
from references.images import read_rgb

HERE = Path(__file__).parent

SIZE, TILE = 64, 8
SAMPLES_OF_CHECKS = 4  # a run takes this many times the samples of a run of ./lab check
LIMITS = {"z": 4, "mean": 1, "noise": 1.4, "rays": 1.4}
# What chapter.json must contain: scenes and options. Together, the scenes have everything that an estimator must handle.
SETTINGS = {
    (): [
        ("cornell_box", "--max-path-length 5"),
        ("cornell_box", "--max-path-length 4 --only-path-length 2"),
        (HERE / "under_the_sky.json", "--max-path-length 3"),
        ("textured", "--max-path-length 3"),
        ("glossy", "--max-path-length 4"),
        ("furnace", "--max-path-length 4"),
    ],
    ("bounces",): [
        ("furnace", "--max-path-length 4 --strategy bounces"),
        ("heart_light", "--max-path-length 4"),
        ("cornell_box", "--max-path-length 3 --strategy bounces"),
    ],
    ("--splitting-factor",): [
        (HERE / "under_the_sky.json", "--max-path-length 2 --splitting-factor 1"),
        ("cornell_box", "--max-path-length 1 --splitting-factor 3"),
    ],
    ("--splitting-factor", "--survival-cap"): [
        ("cornell_box", "--max-path-length 40 --splitting-factor 3 --survival-cap 0.6 --roulette-start 2")
    ],
    ("dielectrics",): [("glass", "--max-path-length 8"), ("glass", "--max-path-length 6 --only-path-length 3")],
    ("both", "--survival-cap"): [
        ("plates", "--max-path-length 2"),
        ("heart_light", "--max-path-length 2 --strategy light"),
        ("cornell_box", "--max-path-length 40 --survival-cap 0.6 --roulette-start 2"),
    ],
    ("light_probe_sampling",): [
        ("sunny", "--max-path-length 3"),
        ("studio", "--max-path-length 3"),
        ("textured", "--max-path-length 2 --strategy light"),
    ],
    ("microfacets",): [("microfacets", "--max-path-length 4"), ("microfacets", "--max-path-length 3 --strategy light")],
}


def settings_of(chapter):
    """The scenes and options that a chapter supports."""
    says = DESCRIPTIONS[chapter]
    abilities = {key for key, value in says.items() if value is True} | {*says.get("options", []), *says.get("strategies", [])}
    return [setting for needed, those in SETTINGS.items() if abilities.issuperset(needed) for setting in those]


def samples_of(chapter):
    return SAMPLES_OF_CHECKS * SCENES[chapter][0]


def render(chapter, file, shader, scene, options, seeds):
    """Images [seed, row, column, channel] and rays per sample, from a chapter's program with this file instead of its shader."""
    images, rays = [], 0
    with tempfile.TemporaryDirectory() as folder:
        picture, report = Path(folder) / "a.exr", Path(folder) / "a.json"
        for seed in seeds:
            command = [
                program_file(CHAPTERS[chapter]),
                scene,
                *Submission(chapter, file, shader).options,
                *options.split(),
                "--width",
                SIZE,
                "--height",
                SIZE,
                "--samples",
                samples_of(chapter),
                "--seed",
                seed,
                "--output",
                picture,
                "--report",
                report,
                "--headless",
                "--quiet",
                "--backend",
                "compute",
            ]
            ended = run_program(command)
            if ended.returncode != 0:
                sys.exit(f"error: {file} {scene}: {ended.stderr.strip()}")
            images.append(read_rgb(picture))
            rays += read_json(report)["rows"][-1]["rays"]
    return np.array(images), rays / (len(images) * SIZE**2 * samples_of(chapter))


def tile_means(image):
    return image.reshape(SIZE // TILE, TILE, SIZE // TILE, TILE).mean(axis=(1, 3))


def compare(images, rays, own_images, own_rays):
    """Largest |z|, relative difference of the means, and ratios of noise and rays to the chapter's own."""
    grey, own_grey = images.mean(axis=3), own_images.mean(axis=3)
    difference = grey.mean(axis=0) - own_grey.mean(axis=0)
    variance = grey.var(axis=0, ddof=1) / len(grey) + own_grey.var(axis=0, ddof=1) / len(own_grey)
    tiles = tile_means(difference) / np.sqrt(tile_means(variance) / TILE**2 + 1e-13)
    whole = difference.mean() / np.sqrt(variance.mean() / SIZE**2 + 1e-13)
    # Geometric mean of the tiles' ratios: a few very bright samples would dominate the image's own ratio.
    mean = (images.mean(axis=0) + own_images.mean(axis=0)) / 2
    noise, own_noise = [
        tile_means((x.var(axis=0, ddof=1) / (mean**2 + 0.01 * mean.mean() ** 2)).mean(axis=2)) for x in (images, own_images)
    ]
    return {
        "z": max(abs(whole), np.abs(tiles).max()),
        "mean": difference.mean() / own_grey.mean(),
        "noise": np.exp(np.log((noise + 1e-10) / (own_noise + 1e-10)).mean()),
        "rays": rays / own_rays,
    }


def main():
    parser = Parser("./lab notebook variants", __doc__)
    parser.add_argument("files", nargs="*", type=Path, metavar="FILE", help="of variants; without any, all of them")
    parser.add_argument("--first-seed", type=number(int, 1), default=1, help="default: 1")
    parser.add_argument("--seeds", type=number(int, 2), default=8, help="of each of both, default: 8")
    options = parser.parse_args()
    first, count = options.first_seed, options.seeds
    files = [file.resolve() for file in options.files]
    chosen = [(chapter, file, shader) for chapter, file, shader, _ in variants() if file in files or not files]
    started, own, is_near = time.monotonic(), {}, True
    for done, (chapter, file, shader) in enumerate(chosen, 1):
        results = {}
        for setting in settings_of(chapter):
            if (chapter, *setting) not in own:
                own[chapter, *setting] = render(
                    chapter, own_shader(chapter), None, *setting, range(first + count, first + 2 * count)
                )
            rendered = render(chapter, file, shader, *setting, range(first, first + count))
            results[" ".join([Path(setting[0]).stem, setting[1]])] = compare(*rendered, *own[chapter, *setting])
        worst = {kind: max(results, key=lambda setting: abs(results[setting][kind])) for kind in LIMITS}
        is_near &= all(abs(results[setting][kind]) < LIMITS[kind] for kind, setting in worst.items())
        name = f"{CHAPTERS[chapter]}/{file.name}"
        print(name, *(f"{kind} {results[at][kind]:.3f} ({at})" for kind, at in worst.items()), flush=True)
        show_progress(name, done, len(chosen), started)
    sys.exit(0 if is_near else "error: not every estimator is as near to its chapter's own as it must be")
