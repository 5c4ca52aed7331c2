#!/usr/bin/env python3
"""Renders and plots all pictures of the pages into docs/pictures, then writes the tables of docs/results.md,
docs/numerics.md and the chapter pages from the records. Ctrl-C keeps what is there; the same command goes on.
"""
import argparse
import hashlib
import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

try:
    import figure_plots
    from command_line import Parser, run_resumable
    from make_results import kind_of, load_records
    from measurement import BINARIES, CHAPTERS, digest_of_sources, last_line
    from progress import show_progress
    from reference_image import ROOT, read_rgb
    from report_numbers import last_rows, mean_of
except ImportError as error:
    sys.exit(f"error: {error}: ./lab figures needs the Python packages numpy and matplotlib")

PICTURES = ROOT / "docs/pictures"
CACHE = ROOT / "output/figures"  # renders, in a folder for each state of the sources
RAYS_PER_PIXEL = 400  # of the chapters' pictures
SECONDS = 2  # of the renders that are compared at equal time


@dataclass
class Render:
    """A render with a chapter's program, kept until the sources change."""

    name: str
    chapter: int
    scene: str
    size: int
    options: tuple
    rays_per_pixel: int = 0  # instead of --samples, if not 0

    def file(self, folder):
        """Of the image. Its name changes with whatever is rendered."""
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
            command = [BINARIES / CHAPTERS[self.chapter - 1], self.scene, "--width", self.size, "--height", self.size, *options,
                       "--backend", "compute", "--quiet", "--output", unfinished, "--report", report]
            process = subprocess.run(list(map(str, command)), cwd=ROOT, stdin=subprocess.DEVNULL, capture_output=True,
                                     text=True, start_new_session=True)  # in a session of its own Ctrl-C does not reach it
            if process.returncode != 0:
                sys.exit(f"error: {self.name}: {last_line(process.stderr) or f'exit code {process.returncode}'}")
            os.replace(unfinished, file)
        return json.loads(report.read_text(encoding="utf-8"))

    def samples_for_rays(self, folder):
        pilot = Render(f"{self.name}_pilot", self.chapter, self.scene, self.size, (*self.options, "--samples", 1))
        rays = pilot.run(folder)["rows"][-1]["rays"]
        return max(1, round(self.rays_per_pixel * self.size**2 / rays))


def renders_of_chapters():
    scenes = {6: "glass"}
    return [Render(name, number, scenes.get(number, "cornell_box"), 320, (), RAYS_PER_PIXEL)
            for number, name in enumerate(CHAPTERS[:6], 1)]


def renders_of_path_lengths():
    return [Render(f"only_{length}", 3, "cornell_box", 160, ("--samples", 256, "--only-path-length", length,
                                                             "--max-path-length", 9)) for length in range(10)]


def renders_of_effects():
    return [Render("occlusion", 2, "instances", 256, ("--samples", 256, "--background", "1,1,1", "--max-path-length", 1)),
            Render("shadow", 3, "heart_light", 256, ("--samples", 256, "--max-path-length", 1)),
            Render("reflection", 3, "glossy", 256, ("--samples", 256, "--specular"))]


def renders_at_equal_time():
    """As many samples as take the same time by the first record of docs/records/chapters, whatever else runs now."""
    renders, size = [], 160
    for case in load_records("chapters")[0]["cases"]:
        if kind_of(case) == "chapter" and not case["scene"].startswith("torus"):
            seconds = mean_of(last_rows(case["runs"]), "device_seconds") / (case["samples"] * case["width"] * case["height"])
            scene, number = Path(case["scene_file"]).stem, int(case["program"][:2])
            options = ("--samples", round(SECONDS / (seconds * size**2)), "--max-path-length", case["max_path_length"])
            renders.append(Render(f"{scene}_{number}", number, scene, size, options))
    return renders


def renders_of_convergence():
    """Four runs of each chapter, whose errors are averaged."""
    reference = ("--reference", "assets/references/cornell_box_6.exr", "--max-path-length", 6)
    return [Render(f"run_{number}_{seed}", number, "cornell_box", 128, ("--samples", samples, "--seed", seed, *reference))
            for number, samples in enumerate((256, 256, 256, 64, 64), 1) for seed in range(1, 5)]


def renders_of_bvh_steps():
    return [Render(f"steps_{scene}", 1, scene, 256, ("--samples", 4, "--view", "bvh-steps")) for scene in ("torus", "instances")]


# Name of the figure: the renders that it needs, and the function of figure_plots that makes it of images and reports.
FIGURES = {
    "chapters": (renders_of_chapters(), figure_plots.chapters),
    "path_lengths": (renders_of_path_lengths(), figure_plots.path_lengths),
    "effects": (renders_of_effects(), figure_plots.effects),
    "bvh_steps": (renders_of_bvh_steps(), figure_plots.bvh_steps),
    "equal_time": (renders_at_equal_time(), figure_plots.equal_time),
    "convergence": (renders_of_convergence(), figure_plots.convergence),
    "sampler_points": ([], figure_plots.sampler_points),
    "one_over_root_n": ([], figure_plots.one_over_root_n),
    "grid_and_random": ([], figure_plots.grid_and_random),
    "random_numbers": ([], figure_plots.random_numbers),
    "window": ([], figure_plots.window),
}


def parse():
    parser = Parser(prog="./lab figures", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all of {', '.join(FIGURES)}")
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
    steps = [(name, render) for name in names for render in [*FIGURES[name][0], None]]
    started = time.monotonic()
    for done, (name, render) in enumerate(steps, 1):
        renders, compose = FIGURES[name]
        if render:
            (folder / name).mkdir(parents=True, exist_ok=True)
            render.run(folder / name)
        else:
            images = {render.name: read_rgb(render.file(folder / name)) for render in renders}
            compose(output, images, {render.name: render.run(folder / name) for render in renders})
        show_progress(f"{name}{f', {render.name}' if render else ''}", done, len(steps), started)


def main():
    options = parse()
    run_resumable(lambda: make(options.names or list(FIGURES), options.output), OSError)
    if not options.names:
        for tool in ("make_results.py", "make_numerics.py"):
            subprocess.run([sys.executable, ROOT / "tools" / tool], check=True)


if __name__ == "__main__":
    main()
