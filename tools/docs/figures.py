"""Renders and plots all pictures of the pages into docs/pictures, then fills the tables of the pages from the records. Ctrl-C
keeps what is there; the same command goes on.
"""
import hashlib
import os
import time
from contextlib import nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from check.grading import OPTIONS, SCENES, program_with
from course.bug import new_render
from docs import figure_plots, first_steps, tables
from docs.bug_blocks import GALLERY, find_bug
from project import (BINARIES, CHAPTERS, ROOT, Parser, UserError, chapter_named, description, failure_text, load_records, read_json,
                     run_program, show_progress)
from references.images import read_rgb
from report.measurement import digest_of_sources
from report.numbers import per_sample

GOES_ON = True
PICTURES = ROOT / "docs/pictures"
CACHE = ROOT / "output/figures"  # renders, in a folder for each state of the sources
RAYS_PER_PIXEL = 400  # of the chapters' pictures
SECONDS = 2  # of the renders that are compared at equal time
HERO_SAMPLES = 256  # of the picture at the head of the README


@dataclass
class Render:
    """A render with a chapter's program, kept until the sources change."""

    name: str
    chapter: str
    scene: str
    size: int  # width, and height unless that is given
    options: tuple
    rays_per_pixel: int = 0  # instead of --samples, if not 0
    height: int = 0
    shader: str = ""  # its text, instead of the chapter's own

    def file(self, folder):
        """The file of the image. Its name changes with whatever is rendered."""
        return folder / f"{self.name}_{hashlib.sha256(repr(self).encode()).hexdigest()[:8]}.exr"

    def run(self, folder):
        """Makes the image, unless it is there; returns the report of the chapter."""
        file = self.file(folder)
        report = file.with_suffix(".json")
        if not file.exists():
            options = self.options
            if self.rays_per_pixel:
                options = (*options, "--samples", self.samples_for_rays(folder))
            unfinished = file.with_suffix(".unfinished.exr")
            with program_with(self.chapter, self.shader) if self.shader else nullcontext(BINARIES / self.chapter) as program:
                process = run_program([program, self.scene, "--width", self.size, "--height", self.height or self.size, *options,
                                       "--backend", "compute", "--quiet", "--output", unfinished, "--report", report])
            if process.returncode != 0:
                raise UserError(f"{self.name}: {failure_text(process)}")
            os.replace(unfinished, file)
        return read_json(report)

    def samples_for_rays(self, folder):
        pilot = Render(f"{self.name}_pilot", self.chapter, self.scene, self.size, (*self.options, "--samples", 1))
        rays = pilot.run(folder)["rows"][-1]["rays"]
        return max(1, round(self.rays_per_pixel * self.size**2 / rays))


def renders_of_chapters():
    """All but those whose strategies are compared in a figure of their own."""
    return [Render(name, name, description(name).get("default_scene", "cornell_box"), 320, (), RAYS_PER_PIXEL)
            for name in CHAPTERS.values() if not description(name).get("strategies")]


def renders_of_thumbnails():
    """Small pictures of all chapters, for the same number of rays."""
    scenes = {"low_discrepancy_points": "textured", "path_regeneration": "still_life"}
    return [Render(f"{number:02}", name, scenes.get(name[3:], description(name).get("default_scene", "cornell_box")), 120, (),
                   RAYS_PER_PIXEL) for number, name in CHAPTERS.items()]


def renders_of_strategies():
    """Light that is reflected once, so that nothing but the strategies makes a difference."""
    chapter = chapter_named("multiple_importance_sampling")
    return [Render(f"strategy_{strategy}", chapter, "plates", 384, ("--samples", 16, "--max-path-length", 1, "--strategy", strategy),
                   height=256) for strategy in ("light", "brdf", "both")]


def renders_of_neighbours(scenes, chapters, options=(), rays_per_pixel=0):
    """Chapters beside each other, for the same number of rays."""
    return [Render(f"{scene}_{int(chapter[:2])}", chapter, scene, 320, options, rays_per_pixel)
            for scene in scenes for chapter in map(chapter_named, chapters)]


def renders_of_light_probes():
    chapters = ("multiple_importance_sampling", "light_probes")
    return renders_of_neighbours(("sunny", "studio"), chapters, rays_per_pixel=RAYS_PER_PIXEL)


def renders_of_low_discrepancy():
    """Light that is reflected once, where the points matter most."""
    chapters = ("light_probes", "low_discrepancy_points")
    return renders_of_neighbours(("cornell_box", "textured"), chapters, ("--samples", 64, "--max-path-length", 1))


def renders_of_idle_lanes():
    """Who waits, in chapters 9 and 10."""
    return renders_of_neighbours(("cornell_box", "glass"), ("low_discrepancy_points", "path_regeneration"),
                                 ("--samples", 4, "--view", "idle-lanes"))


def renders_of_bugs():
    """Each bug of the gallery beside the right picture, as ./lab bug renders them but with less noise."""
    renders = []
    for name, (chapter, scene) in GALLERY.items():
        bug, _ = find_bug(name)
        case = new_render(chapter, scene, CHAPTERS[chapter])
        options = ("--samples", 4 * SCENES[chapter][0], "--max-path-length", case["max_path_length"], *OPTIONS[chapter])
        renders += [Render(f"{name}_{which}", CHAPTERS[chapter], Path(case["scene_file"]).stem, case["width"], options,
                           height=case["height"], shader=text) for which, text in (("right", ""), ("wrong", bug.text))]
    return renders


def renders_of_noise_and_bias():
    """The right shader and one with a mistake, each with few and with many samples."""
    bug, _ = find_bug("missing-cosine")
    return [Render(f"{which}_{samples}", CHAPTERS[bug.chapter], "cornell_box", 224, ("--samples", samples, "--max-path-length", 6),
                   shader=text) for which, text in (("right", ""), ("wrong", bug.text)) for samples in (16, 2048)]


def renders_of_path_lengths():
    return [Render(f"only_{length}", chapter_named("next_event_estimation"), "cornell_box", 160,
                   ("--samples", 256, "--only-path-length", length, "--max-path-length", 9)) for length in range(10)]


def renders_of_effects():
    cosine, light = chapter_named("cosine_sampling"), chapter_named("next_event_estimation")
    return [Render("occlusion", cosine, "instances", 256, ("--samples", 256, "--background", "1,1,1", "--max-path-length", 1)),
            Render("shadow", light, "heart_light", 256, ("--samples", 256, "--max-path-length", 1)),
            Render("reflection", light, "glossy", 256, ("--samples", 256, "--specular"))]


def renders_at_equal_time(scenes=("cornell_box", "heart_light"), size=160):
    """Takes the samples that fit into SECONDS by the first record of docs/records/chapters, whatever else runs now."""
    renders = []
    for case in load_records("chapters")[0]["cases"]:
        if tables.kind_of(case) == "chapter" and case["scene"].startswith(scenes):
            scene = Path(case["scene_file"]).stem
            options = ("--samples", round(SECONDS / (per_sample(case, "device_seconds") * size**2)), "--max-path-length", case["max_path_length"])
            renders.append(Render(f"{scene}_{int(case['program'][:2])}", case["program"], scene, size, options))
    return renders


def renders_of_hero():
    return [Render("hero", chapter_named("path_regeneration"), "still_life", 1600,
                   ("--samples", HERO_SAMPLES, "--max-path-length", 16), height=900)]


def renders_of_convergence():
    """Four runs of each chapter whose error differs in the Cornell box, whose errors are averaged; a sample of splitting is several
    paths."""
    reference = ("--reference", "assets/references/cornell_box_6.exr", "--max-path-length", 6)
    others = [chapter_named(name) for name in ("dielectrics", "light_probes", "path_regeneration")]
    return [Render(f"run_{number}_{seed}", name, "cornell_box", 128,
                   ("--samples", 64 if "--splitting-factor" in description(name).get("options", []) else 256, "--seed", seed,
                    *reference))
            for number, name in CHAPTERS.items() if name not in others for seed in range(1, 5)]


def renders_of_bvh_steps():
    return [Render(f"steps_{scene}", CHAPTERS[1], scene, 256, ("--samples", 4, "--view", "bvh-steps")) for scene in ("torus", "instances")]


def renders_of_first_steps():
    """The tiles of each step's picture, named step_NUMBER_WHAT. Those that are noisy have 256 samples."""
    shaders = first_steps.shaders(first_steps.PAGE.read_text(encoding="utf-8"))
    close = ("--camera-target", "-0.2,0.6,0", "--vertical-fov", 7)

    def tile(step, what="", samples=256, scene="cornell_box", view=()):
        options = ("--samples", samples, "--max-path-length", 6, *view)
        shader = shaders[f"{step} broken" if what.endswith("broken") else str(step)]
        return Render(f"step_{step}{what}", CHAPTERS[1], scene, 256, options, shader=shader)

    return [*(tile(step, samples=16) for step in (1, 2, 3)),
            *(tile(3, what, 16, "torus", close) for what in ("_torus", "_torus_broken")), tile(4, samples=16),
            *(tile(step, what) for step in (5, 6, 7) for what in ("", "_broken")),
            tile(8, "_1_sample", 1), tile(8, "_16_samples", 16), tile(8, "_256_samples"), tile(8, "_broken", 16)]


ON_REQUEST = {"hero"}  # takes two cores half an hour

# Name of the figure, and of what makes it in figure_plots: a function for the renders that it needs.
FIGURES = {
    "chapters": renders_of_chapters, "thumbnails": renders_of_thumbnails, "strategies": renders_of_strategies,
    "light_probes": renders_of_light_probes, "low_discrepancy": renders_of_low_discrepancy, "idle_lanes": renders_of_idle_lanes,
    "path_lengths": renders_of_path_lengths, "effects": renders_of_effects, "bugs": renders_of_bugs, "bvh_steps": renders_of_bvh_steps,
    "noise_and_bias": renders_of_noise_and_bias, "hero": renders_of_hero,
    "noise": partial(renders_at_equal_time, ("cornell_box",), 256), "equal_time": renders_at_equal_time,
    "convergence": renders_of_convergence, "first_steps": renders_of_first_steps, "sampler_points": list, "point_sets": list,
    "one_over_root_n": list, "grid_and_random": list, "random_numbers": list, "window": list,
}


def parse():
    parser = Parser("./lab figures", __doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all of {', '.join(FIGURES)}, but not {', '.join(ON_REQUEST)}")
    parser.add_argument("--output", type=Path, default=PICTURES, metavar="FOLDER", help="default: docs/pictures")
    options = parser.parse_args()
    for name in options.names:
        if name not in FIGURES:
            parser.error(f"there is no figure '{name}': {', '.join(FIGURES)}")
    return options


def make(names, output):
    output = output.resolve()
    output.mkdir(parents=True, exist_ok=True)
    folder = CACHE / digest_of_sources([])
    renders = {name: FIGURES[name]() for name in names}
    steps = [(name, render) for name in names for render in [*renders[name], None]]
    started = time.monotonic()
    for done, (name, render) in enumerate(steps, 1):
        if render:
            (folder / name).mkdir(parents=True, exist_ok=True)
            render.run(folder / name)
        else:
            images = {render.name: read_rgb(render.file(folder / name)) for render in renders[name]}
            getattr(figure_plots, name)(output, images, {render.name: render.run(folder / name) for render in renders[name]})
        show_progress(f"{name}{f', {render.name}' if render else ''}", done, len(steps), started)


def main():
    options = parse()
    make(options.names or [name for name in FIGURES if name not in ON_REQUEST], options.output)
    if not options.names:
        tables.write_pages()
