"""Draws the pages' figures from images, reports and sampler points."""
import functools
import math
import shutil

import matplotlib

matplotlib.use("agg")
import numpy as np
from docs.page_plots import STYLE, finish_axis, lines, new_figure, plain, with_name
from lesson import sample
from lesson.sample_plots import save_point_sets, scatter
from matplotlib import image, pyplot
from project import BINARIES, ROOT, UserError, run_program, write_bytes
from report.numbers import Series
from report.plots import COLOURS, QUALITY, encode_srgb, right_and_wrong, save_figure, sheet, style_axis, svg_text


# ---------------------------------------------------------------------------------------------- of renders
TONES = {"srgb": encode_srgb, "linear": lambda image: image, "relative": lambda image: encode_srgb(image / image.max())}


def labelled(render):
    """The label and pixels of a render's tile."""
    facts = {
        "number": int(render.chapter[:2]),
        "scene": render.scene,
        "samples": render.report["rows"][-1]["samples"],
        "mean": render.image.mean(),
        "largest": render.image.max(),
    }
    return render.label.format(**facts), TONES[render.tone](render.image)


def sheet_of(name):
    """A figure NAME.jpg of labelled tiles in rows."""

    def draw(folder, renders):
        rows = {}
        for render in renders:
            rows.setdefault(render.row, []).append(labelled(render))
        sheet(folder / f"{name}.jpg", list(rows.values()))

    return draw


def chapters(folder, renders):
    """One picture per chapter."""
    for render in renders:
        image.imsave(folder / f"{render.name}.png", bytes_of(render.image), pil_kwargs={"optimize": True})


def thumbnails(folder, renders):
    for render in renders:
        image.imsave(folder / f"thumbnail_{render.name}.jpg", encode_srgb(render.image), pil_kwargs=QUALITY)


def hero(folder, renders):
    """The picture at the top of the README, slightly darker because of its glowing heart."""
    image.imsave(folder / "hero.jpg", encode_srgb(0.66 * renders[0].image), pil_kwargs=QUALITY)


def path_lengths(folder, renders):
    """Light after at most k bounces, and after exactly k; the latter are brightened by the factor in their label."""
    exact = [render.image for render in renders]
    factors = [1, 1, 2, 4, 4, 8, 16, 16, 32, 32]
    for name, tiles in (
        ("path_length_at_most", [(f"at most {k}", encode_srgb(radiance)) for k, radiance in enumerate(np.cumsum(exact, axis=0))]),
        (
            "path_length_exactly",
            [
                (f"exactly {k}" + (f", × {factor}" if factor > 1 else ""), encode_srgb(factor * radiance))
                for k, (radiance, factor) in enumerate(zip(exact, factors))
            ],
        ),
    ):
        sheet(folder / f"{name}.jpg", [row for row in (tiles[:5], tiles[5:]) if row])


def bytes_of(radiance):
    return (255 * encode_srgb(radiance)).round().astype(np.uint8)


def bugs(folder, renders):
    """A strip for each bug: bugs_NAME.jpg."""
    for right, wrong in zip(renders[::2], renders[1::2]):
        right_and_wrong(folder / f"bugs_{right.name.removesuffix('_right')}.jpg", right.image, wrong.image)


def first_steps(folder, renders):
    """A picture of each step's tiles; renders are named step_NUMBER_WHAT."""
    steps = {}
    for render in renders:
        steps.setdefault(render.name.split("_")[1], []).append((render.name.replace("_", " "), encode_srgb(render.image)))
    for number, tiles in steps.items():
        sheet(folder / f"first_steps_{number}.jpg", [tiles])


def convergence(folder, renders):
    """Error against samples and against seconds, with 95 % bars from the runs of each chapter."""
    figure, axes = new_figure(360, columns=2, sharey=True)
    runs = {}
    for render in renders:
        runs.setdefault(int(render.chapter[:2]), []).append(render.report["rows"])
    for index, (number, rows) in enumerate(runs.items()):
        errors = [Series(dict(enumerate(math.sqrt(row["rel_mse"]) for row in step))).interval() for step in zip(*rows)]
        for axis, key in zip(axes, ("samples", "seconds")):
            lines(axis, [np.mean([row[key] for row in step]) for step in zip(*rows)], errors, index, with_name(number))
    for axis, label in zip(axes, ("samples per pixel", "seconds")):
        finish_axis(axis, xscale="log", yscale="log", xlabel=label)
        axis.xaxis.set_major_formatter(plain)
        axis.yaxis.set_major_formatter(plain)
    axes[0].set_ylabel("relative error (root of rel_mse)")
    axes[1].legend(loc="upper right")
    write_bytes(folder / "convergence.svg", svg_text(figure).encode())


# ---------------------------------------------------------------------------------------------- of points
def on_any_ground(draw):
    """Draws a figure without a ground, so that it can be read on white and on black."""

    @functools.wraps(draw)
    def drawn(folder, renders):
        with pyplot.rc_context(STYLE | {"font.size": 10}):
            draw(folder, renders)

    return drawn


@on_any_ground
def sampler_points(folder, renders):
    shown = [playground for playground in sample.OF_CHAPTERS.values() if not playground.is_pixel]
    figure, axes = pyplot.subplots(1, len(shown), figsize=(11, 3.9), layout="constrained")
    for axis, playground in zip(axes, shown):
        scatter(axis, playground.kind, sample.draw(playground, 2000, 0, playground.dimensions))
        axis.set_title(playground.title.replace(", density", "\ndensity"), fontsize=9)
    save_figure(figure, folder / "sampler_points.png")


def mean_errors(terms, exact, sizes):
    """Root mean squared error of estimates from n terms each, for each n in `sizes`."""
    return [np.sqrt(((terms[: len(terms) // n * n].reshape(-1, n).mean(axis=1) - exact) ** 2).mean()) for n in sizes]


@on_any_ground
def point_sets(folder, renders):
    save_point_sets(folder / "point_sets.png", sample.draw_sets(0), sample.COMPARED)


@on_any_ground
def one_over_root_n(folder, renders):
    playground = sample.PLAYGROUNDS["1d"]
    integral, sizes = playground.integrals[0], 2 ** np.arange(15)
    terms = integral.terms(sample.draw(playground, 2**20, 0, 1))
    errors = mean_errors(terms, integral.value(1), sizes)
    figure, axis = pyplot.subplots(figsize=(6, 4), layout="constrained")
    axis.plot(sizes, errors, "o", color=COLOURS[0], label=f"error of {integral.formula}")
    axis.plot(sizes, terms.std() / np.sqrt(sizes), color=COLOURS[4], label="standard deviation of f(u) / √N")
    style_axis(axis, xscale="log", yscale="log", xlabel="N", ylabel="root mean squared error")
    axis.legend(frameon=False, fontsize=9)
    save_figure(figure, folder / "one_over_root_n.png")


@on_any_ground
def grid_and_random(folder, renders):
    playground = sample.PLAYGROUNDS["kd"]
    integral = playground.integrals[0]
    figure, axes = pyplot.subplots(1, 4, figsize=(13, 3.6), sharey=True, layout="constrained")
    for axis, k in zip(axes, (1, 2, 4, 8)):
        sizes = 2 ** np.arange(0, 17, 2)
        terms = integral.terms(sample.draw(playground, 2**20, 0, k))
        axis.plot(
            sizes, mean_errors(terms, integral.value(k), sizes), "o-", color=COLOURS[0], markersize=4, label="random: N^(−1/2)"
        )
        n, corners, midpoints = zip(*sample.grid_rows(integral, k, 2**16))
        axis.plot(n, corners, "s-", color=COLOURS[4], markersize=4, label=f"grid of corners: N^(−1/{k})")
        axis.plot(n, midpoints, "D-", color=COLOURS[1], markersize=4, label=f"grid of midpoints: N^(−2/{k})")
        style_axis(axis, xscale="log", yscale="log", xlabel="N", title=f"k = {k}", ylim=(1e-7, 2))
        axis.legend(frameon=False, fontsize=8, loc="lower left")
    axes[0].set_ylabel("error")
    save_figure(figure, folder / "grid_and_random.png")


@on_any_ground
def random_numbers(folder, renders):
    """A small corner of the unit square, where single values can be seen."""
    figure, axes = pyplot.subplots(1, 2, figsize=(8, 4.2), layout="constrained")
    for axis, name, title in zip(axes, ("numbers", "blog-hash"), ("PCG2D", "frac(sin(dot(p, …)) · 43758.5)")):
        playground = sample.PLAYGROUNDS[name]
        points = sample.draw(playground, 2**20, 0, 2)
        corner = points[(points < 1 / 32).all(axis=1)]
        axis.plot(corner[:, 0], corner[:, 1], ".", color=COLOURS[0], markersize=3, markeredgewidth=0)
        axis.set(title=f"{title}\n{len(corner):,} of {len(points):,} points", xlabel="u_x", ylabel="u_y")
        axis.set_aspect("equal")
    save_figure(figure, folder / "random_numbers.png")


def window(output, renders):
    """Screenshots taken by the window's test: a chapter, and the same chapter after a mistake in its shader."""
    command = ["tests/support/with_display.sh", BINARIES / "viewer_tests", "--gtest_filter=ViewerTest.ShowsThePicture*"]
    process = run_program(command)
    if process.returncode != 0 or "SKIPPED" in process.stdout:
        raise UserError("window: its test " + ("failed" if process.returncode != 0 else "needs Xvfb or a display"))
    for name in ("window.png", "window_broken_shader.png"):
        shutil.copyfile(ROOT / "output" / name, output / name)
