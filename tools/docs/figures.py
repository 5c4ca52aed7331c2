"""Renders and plots the pictures of the pages into docs/pictures, then fills their tables. Ctrl-C keeps finished renders; the same command
then continues.
"""
import hashlib
import os
import time
from contextlib import nullcontext
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from check.grading import OPTIONS, SCENES
from check.submission import replaced
from course.bug import new_render
from docs import figure_plots, first_steps, signed_figures, tables
from docs.bug_blocks import GALLERY, find_bug
from project import BINARIES, CHAPTERS, ROOT, Parser, UserError, failure_text, read_json, run_program, show_progress
from references.images import read_rgb
from report.measurement import digest_of_sources
from report.studies import measures, named

GOES_ON = True
PICTURES = ROOT / "docs/pictures"
CACHE = ROOT / "output/figures"  # renders, one folder per state of the sources
RAYS_PER_PIXEL = 400  # for the chapters' pictures
MEASURES = measures()


@dataclass
class Render:
    """A render by a chapter's program, kept until the sources change."""

    name: str
    chapter: str
    scene: str
    size: int  # width, and height unless specified
    options: tuple
    rays_per_pixel: int = 0  # determines the number of samples, if not 0
    height: int = 0
    shader: str = ""  # its text, instead of the chapter's own
    row: int = field(default=0, repr=False)  # of a sheet
    label: str = field(default="", repr=False)  # a format string, see figure_plots.labelled()
    tone: str = field(default="srgb", repr=False)  # srgb, linear, or relative to the largest value

    def file(self, folder):
        """The file of the image; its name depends on all settings of the render."""
        return folder / f"{self.name}_{hashlib.sha256(repr(self).encode()).hexdigest()[:8]}.exr"

    def run(self, folder):
        """Renders the image unless it exists; keeps the chapter's report."""
        file = self.file(folder)
        report = file.with_suffix(".json")
        if not file.exists():
            options = self.options
            if self.rays_per_pixel:
                options = (*options, "--samples", self.samples_for_rays(folder))
            unfinished = file.with_suffix(".unfinished.exr")
            own = ROOT / "chapters" / self.chapter / "path_trace.glsl"
            with replaced(own, self.shader) if self.shader else nullcontext([]) as shaders:
                process = run_program(
                    [
                        BINARIES / self.chapter,
                        self.scene,
                        *shaders,
                        "--width",
                        self.size,
                        "--height",
                        self.height or self.size,
                        *options,
                        "--backend",
                        "compute",
                        "--quiet",
                        "--output",
                        unfinished,
                        "--report",
                        report,
                    ]
                )
            if process.returncode != 0:
                raise UserError(f"{self.name}: {failure_text(process)}")
            os.replace(unfinished, file)
        self.report, self.image = read_json(report), read_rgb(file)
        return self

    def samples_for_rays(self, folder):
        pilot = Render(
            f"{self.name}_pilot", self.chapter, self.scene, self.size, (*self.options, "--samples", 1), height=self.height
        )
        rays = pilot.run(folder).report["rows"][-1]["rays"]
        return max(1, round(self.rays_per_pixel * self.size * (self.height or self.size) / rays))


def renders_of_tiles(folder, figure):
    """The renders of a figure that a chapter's chapter.json describes. Tiles add their own options, and "chapter" is relative to this one."""
    renders, names = [], list(CHAPTERS.values())
    look = {key: figure[key] for key in ("label", "tone", "rays_per_pixel") if key in figure}
    width, height = figure.get("size", (320, 320))
    for row, tiles in enumerate(figure["rows"]):
        for column, tile in enumerate(tiles):
            chapter = names[names.index(folder) + tile.get("chapter", 0)]
            options = f"{figure.get('options', '')} {tile.get('options', '')}".split()
            own = {"label": tile["label"]} if "label" in tile else {}
            renders.append(
                Render(
                    f"tile_{row}_{column}",
                    chapter,
                    tile.get("scene") or figure["scene"],
                    width,
                    tuple(options),
                    height=height,
                    row=row,
                    **{**look, **own},
                )
            )
    return renders


def renders_of_pictures(key, size, name_of):
    """A picture for each chapter whose chapter.json names its scene, with the same number of rays."""
    return [
        Render(name_of(folder), folder, measure[key], size, (), RAYS_PER_PIXEL)
        for folder, measure in MEASURES.items()
        if key in measure
    ]


def renders_of_bugs():
    """Each bug of the gallery and the right picture, as ./lab bug renders them, but with less noise."""
    renders = []
    for name, (chapter, scene) in GALLERY.items():
        bug, _ = find_bug(name)
        case = new_render(chapter, scene)
        options = ("--samples", 4 * SCENES[chapter][0], "--max-path-length", case["max_path_length"], *OPTIONS[chapter])
        renders += [
            Render(
                f"{name}_{which}",
                CHAPTERS[chapter],
                Path(case["scene_file"]).stem,
                case["width"],
                options,
                height=case["height"],
                shader=text,
            )
            for which, text in (("right", ""), ("wrong", bug.text))
        ]
    return renders


def renders_of_noise_and_bias():
    """The right shader and one with a mistake, each with few and with many samples."""
    bug, _ = find_bug("missing-cosine")
    return [
        Render(
            f"{which}_{samples}",
            CHAPTERS[bug.chapter],
            "cornell_box",
            224,
            ("--samples", samples, "--max-path-length", 6),
            shader=text,
            row=row,
            label=f"{which}, {{samples}} samples per pixel",
        )
        for row, (which, text) in enumerate((("right", ""), ("wrong", bug.text)))
        for samples in (16, 2048)
    ]


def renders_of_convergence():
    """Four runs of each chapter whose error differs in the Cornell box, to be averaged."""
    reference = ("--reference", "assets/references/cornell_box_6.exr", "--max-path-length", 6)
    return [
        Render(
            f"run_{int(folder[:2])}_{seed}",
            folder,
            "cornell_box",
            128,
            ("--samples", measure["convergence_samples"], "--seed", seed, *reference),
        )
        for folder, measure in MEASURES.items()
        if "convergence_samples" in measure
        for seed in range(1, 5)
    ]


def renders_of_first_steps():
    """The tiles of each step's picture, named step_NUMBER_WHAT. Noisy ones have 256 samples."""
    shaders = first_steps.shaders(first_steps.PAGE.read_text(encoding="utf-8"))
    chapter, close = next(iter(CHAPTERS.values())), ("--camera-target", "-0.2,0.6,0", "--vertical-fov", 7)

    def tile(step, what="", samples=256, scene="cornell_box", view=()):
        options = ("--samples", samples, "--max-path-length", 6, *view)
        shader = shaders[f"{step} broken" if what.endswith("broken") else str(step)]
        return Render(f"step_{step}{what}", chapter, scene, 256, options, shader=shader)

    return [
        *(tile(step, samples=16) for step in (1, 2, 3)),
        *(tile(3, what, 16, "torus", close) for what in ("_torus", "_torus_broken")),
        tile(4, samples=16),
        *(tile(step, what) for step in (5, 6, 7) for what in ("", "_broken")),
        tile(8, "_1_sample", 1),
        tile(8, "_16_samples", 16),
        tile(8, "_256_samples"),
        tile(8, "_broken", 16),
    ]


# Name -> (function that makes its renders, function of figure_plots that draws them).
FIGURES = (
    {
        "chapters": (lambda: renders_of_pictures("picture", 320, str), figure_plots.chapters),
        "thumbnails": (lambda: renders_of_pictures("thumbnail", 120, lambda folder: folder[:2]), figure_plots.thumbnails),
        "bugs": (renders_of_bugs, figure_plots.bugs),
        "noise_and_bias": (renders_of_noise_and_bias, figure_plots.sheet_of("noise_and_bias")),
        "convergence": (renders_of_convergence, figure_plots.convergence),
        "first_steps": (renders_of_first_steps, figure_plots.first_steps),
    }
    | {
        name: (partial(getattr(signed_figures, f"renders_of_{name}"), Render, *place), getattr(signed_figures, name))
        for name, place in named("signed_figures").items()
    }
    | {
        name: (list, getattr(figure_plots, name))
        for name in ("sampler_points", "point_sets", "one_over_root_n", "grid_and_random", "random_numbers", "window")
    }
    | {
        name: (
            partial(renders_of_tiles, folder, figure),
            getattr(figure_plots, figure["layout"]) if "layout" in figure else figure_plots.sheet_of(name),
        )
        for name, (folder, figure) in named("figures").items()
    }
)
ON_REQUEST = [name for name, (_, figure) in named("figures").items() if figure.get("takes_long")]


def parse():
    parser = Parser("./lab figures", __doc__)
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"default: all of {', '.join(FIGURES)}, but not {', '.join(ON_REQUEST)}"
    )
    parser.add_argument("--output", type=Path, default=PICTURES, metavar="FOLDER", help="default: docs/pictures")
    options = parser.parse_args()
    for name in options.names:
        if name not in FIGURES:
            parser.error(f"there is no figure '{name}'")
    return options


def make(names, output):
    output = output.resolve()
    output.mkdir(parents=True, exist_ok=True)
    folder = CACHE / digest_of_sources([])
    renders = {name: FIGURES[name][0]() for name in names}
    steps = [(name, render) for name in names for render in [*renders[name], None]]
    started = time.monotonic()
    for done, (name, render) in enumerate(steps, 1):
        if render:
            (folder / name).mkdir(parents=True, exist_ok=True)
            render.run(folder / name)
        else:
            FIGURES[name][1](output, renders[name])
        show_progress(f"{name}{f', {render.name}' if render else ''}", done, len(steps), started)


def main():
    options = parse()
    make(options.names or [name for name in FIGURES if name not in ON_REQUEST], options.output)
    if not options.names:
        tables.write_all()
