"""The figures of the pages, made of images, reports and points of samplers."""
import shutil

import matplotlib

matplotlib.use("agg")
import numpy as np
from lesson import sample
from lesson.sample_plots import save_point_sets, scatter
from matplotlib import font_manager, image, pyplot
from PIL import Image, ImageDraw, ImageFont
from project import BINARIES, CHAPTERS, ROOT, UserError, run_program
from report.plots import (COLOURS, DIFFERENCE_FACTOR, MARKERS, difference_colours, encode_srgb, relative_difference, save_figure,
                          style_axis)

DPI = 100
GAP, LABEL = 4, 22  # pixels between tiles, height of a label
QUALITY = {"quality": 88, "optimize": True}  # of JPEG files


def sheet(path, rows):
    """Rows of pairs (label, pixels in [0, 1]) side by side, pixel for pixel."""
    height, width = rows[0][0][1].shape[:2]
    columns = max(map(len, rows))
    size = np.array([columns * (width + GAP) + GAP, len(rows) * (height + LABEL + GAP)])
    figure = pyplot.figure(figsize=size / DPI)
    for j, row in enumerate(rows):
        for i, (label, pixels) in enumerate(row):
            corner = np.array([GAP + i * (width + GAP), size[1] - (j + 1) * (height + LABEL) - j * GAP])
            axis = figure.add_axes([*corner / size, *np.array([width, height]) / size])
            axis.imshow(pixels, interpolation="nearest")
            axis.axis("off")
            figure.text(*(corner + [0, height + 6]) / size, label, fontsize=9)
    save_figure(figure, path, DPI, **({"pil_kwargs": QUALITY} if path.suffix == ".jpg" else {}))


def right_and_wrong(path, right, wrong):
    """Two images of a scene beside each other, and where the wrong one is too bright (red) or too dark (blue). Colours are full
    where a report's are, or where only one pixel in ten differs more."""
    difference = relative_difference(wrong, right)
    full = max(1 / DIFFERENCE_FACTOR, np.quantile(np.abs(difference), 0.9))
    sheet(path, [[("right", encode_srgb(right)), ("wrong", encode_srgb(wrong)),
                  ("red: too bright, blue: too dark", difference_colours(difference, full))]])


def plot(path, size, draw, **labels):
    """A plot with logarithmic axes, drawn by a function of its axis."""
    figure, axis = pyplot.subplots(figsize=size, layout="constrained")
    draw(axis)
    style_axis(axis, xscale="log", yscale="log", **labels)
    axis.legend(frameon=False, fontsize=9)
    save_figure(figure, path)


# ---------------------------------------------------------------------------------------------- of renders
def chapters(folder, images, reports):
    """One picture a chapter, for about the same number of rays."""
    for name, radiance in images.items():
        image.imsave(folder / f"{name}.png", (255 * encode_srgb(radiance)).round().astype(np.uint8),
                     pil_kwargs={"optimize": True})


def noise_and_bias(folder, images, reports):
    """A row for each shader, from few samples to many."""
    rows = {}
    for name, radiance in images.items():
        which, samples = name.split("_")
        rows.setdefault(which, []).append((f"{which}, {samples} samples per pixel", encode_srgb(radiance)))
    sheet(folder / "noise_and_bias.jpg", list(rows.values()))


def thumbnails(folder, images, reports):
    for name, radiance in images.items():
        image.imsave(folder / f"thumbnail_{name}.jpg", encode_srgb(radiance), pil_kwargs=QUALITY)


def path_lengths(folder, images, reports):
    """Light after at most, and after exactly, k bounces; exact ones are brightened as much as their label says."""
    exact, up_to = list(images.values()), []
    for radiance in exact:
        up_to.append(radiance + (up_to[-1] if up_to else 0))
    factors = [1, 1, 2, 4, 4, 8, 16, 16, 32, 32]
    for name, tiles in (
        ("path_length_at_most", [(f"at most {k}", encode_srgb(radiance)) for k, radiance in enumerate(up_to)]),
        ("path_length_exactly", [(f"exactly {k}" + (f", × {factor}" if factor > 1 else ""), encode_srgb(factor * radiance))
                                 for k, (radiance, factor) in enumerate(zip(exact, factors))]),
    ):
        sheet(folder / f"{name}.jpg", [tiles[:5], tiles[5:]])


def effects(folder, images, reports):
    labels = ("ambient occlusion", "soft shadows", "glossy reflections")
    sheet(folder / "effects.jpg", [[(label, encode_srgb(radiance)) for label, radiance in zip(labels, images.values())]])


def strategies(folder, images, reports):
    labels = ("light samples", "bounces", "both")
    sheet(folder / "strategies.jpg", [[(label, encode_srgb(radiance)) for label, radiance in zip(labels, images.values())]])


def bvh_steps(folder, images, reports):
    """White is the largest number of nodes and triangles that a ray of the picture has visited."""
    tiles = [(f"{name.removeprefix('steps_')}: at most {steps.max():.0f} a ray", encode_srgb(steps / steps.max())) for name, steps in images.items()]
    sheet(folder / "bvh_steps.jpg", [tiles])


def rows_by_scene(images, tile):
    """A row of chapters for each scene; renders are named SCENE_CHAPTER, and tile(name, image) says and shows what they are."""
    rows = {}
    for name, radiance in images.items():
        scene, number = name.rsplit("_", 1)
        label, pixels = tile(name, radiance)
        rows.setdefault(scene, []).append((f"chapter {number}: {label}", pixels))
    return list(rows.values())


def hero(folder, images, reports):
    """The picture at the head of the README, a little darker for its glowing heart."""
    image.imsave(folder / "hero.jpg", encode_srgb(0.66 * images["hero"]), pil_kwargs=QUALITY)


def noise(folder, images, reports):
    """A chapter after the other for the same time: an animation with a second and a half for each."""
    frames = []
    for name, radiance in images.items():
        number = int(name.rsplit("_", 1)[1])
        title = CHAPTERS[number][3:].replace("_", " ")
        frame = Image.new("RGB", (2 * radiance.shape[1], 2 * radiance.shape[0] + 2 * LABEL), "white")
        pixels = Image.fromarray((255 * encode_srgb(radiance)).round().astype(np.uint8))
        frame.paste(pixels.resize((frame.width, frame.width), Image.NEAREST), (0, 2 * LABEL))
        font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 22)
        ImageDraw.Draw(frame).text((LABEL // 2, LABEL // 2), f"chapter {number}: {title}", "black", font)
        frames.append(frame)
    frames[0].save(folder / "noise.webp", save_all=True, append_images=frames[1:], duration=1500, loop=0, quality=80)


def samples_by_scene(name):
    """A figure of chapters, which says how many samples each took."""
    def compose(folder, images, reports):
        sheet(folder / f"{name}.jpg", rows_by_scene(images, lambda name, radiance: (
            f"{reports[name]['rows'][-1]['samples']:,} samples", encode_srgb(radiance))))

    return compose


equal_time, light_probes, low_discrepancy = map(samples_by_scene, ("equal_time", "light_probes", "low_discrepancy"))


def idle_lanes(folder, images, reports):
    """Black never waits, and white always does."""
    sheet(folder / "idle_lanes.jpg", rows_by_scene(images, lambda _, parts: (f"idle {parts.mean():.0%} of the time", parts)))


def bugs(folder, images, reports):
    """A strip for each bug: bugs_NAME.jpg."""
    for name in dict.fromkeys(render.rpartition("_")[0] for render in images):
        right_and_wrong(folder / f"bugs_{name}.jpg", images[f"{name}_right"], images[f"{name}_wrong"])


def first_steps(folder, images, reports):
    """A picture of each step's tiles; renders are named step_NUMBER_WHAT."""
    steps = {}
    for name, radiance in images.items():
        steps.setdefault(name.split("_")[1], []).append((name.replace("_", " "), encode_srgb(radiance)))
    for number, tiles in steps.items():
        sheet(folder / f"first_steps_{number}.jpg", [tiles])


def convergence(folder, images, reports):
    """Error against samples and against seconds; means of all runs of a chapter."""
    figure, axes = pyplot.subplots(1, 2, figsize=(10, 4), sharey=True, layout="constrained")
    runs = {}
    for name, report in reports.items():
        runs.setdefault(int(name.split("_")[1]), []).append(report["rows"])
    for (number, rows), colour, marker in zip(runs.items(), COLOURS, MARKERS):
        columns = {key: np.mean([[row[key] for row in run] for run in rows], axis=0) for key in ("samples", "seconds", "rel_mse")}
        for axis, key in zip(axes, ("samples", "seconds")):
            axis.plot(columns[key], np.sqrt(columns["rel_mse"]), marker + "-", color=colour, markersize=4, label=f"chapter {number}")
    for axis, label in zip(axes, ("samples per pixel", "seconds")):
        style_axis(axis, xscale="log", yscale="log", xlabel=label)
    axes[0].set_ylabel("relative error (root of rel_mse)")
    axes[0].legend(frameon=False, fontsize=9)
    save_figure(figure, folder / "convergence.png")


# ---------------------------------------------------------------------------------------------- of points
def sampler_points(folder, images, reports):
    names = ("uniform-angles", "cosine", "light-point")
    figure, axes = pyplot.subplots(1, 3, figsize=(11, 3.9), layout="constrained")
    for axis, name in zip(axes, names):
        playground = sample.PLAYGROUNDS[name]
        scatter(axis, playground.kind, sample.draw(playground.sampler, 2000, 0, playground.dimensions))
        axis.set_title(playground.title.replace(", density", "\ndensity"), fontsize=9)
    save_figure(figure, folder / "sampler_points.png")


def mean_errors(terms, exact, sizes):
    """Root of the mean squared error of estimates from N terms, over as many of them as there are."""
    return [np.sqrt(((terms[: len(terms) // n * n].reshape(-1, n).mean(axis=1) - exact) ** 2).mean()) for n in sizes]


def point_sets(folder, images, reports):
    save_point_sets(folder / "point_sets.png", sample.draw_sets(0), sample.COMPARED)


def one_over_root_n(folder, images, reports):
    playground = sample.PLAYGROUNDS["1d"]
    integral, sizes = playground.integrals[0], 2 ** np.arange(15)
    terms = integral.terms(sample.draw(playground.sampler, 2**20, 0, 1))
    errors = mean_errors(terms, integral.value(1), sizes)

    def draw(axis):
        axis.plot(sizes, errors, "o", color=COLOURS[0], label=f"error of {integral.formula}")
        axis.plot(sizes, terms.std() / np.sqrt(sizes), color=COLOURS[4], label="standard deviation of f(u) / √N")

    plot(folder / "one_over_root_n.png", (6, 4), draw, xlabel="N", ylabel="root mean squared error")


def grid_and_random(folder, images, reports):
    playground = sample.PLAYGROUNDS["kd"]
    integral = playground.integrals[0]
    figure, axes = pyplot.subplots(1, 4, figsize=(13, 3.6), sharey=True, layout="constrained")
    for axis, k in zip(axes, (1, 2, 4, 8)):
        sizes = 2 ** np.arange(0, 17, 2)
        terms = integral.terms(sample.draw(playground.sampler, 2**20, 0, k))
        axis.plot(sizes, mean_errors(terms, integral.value(k), sizes), "o-", color=COLOURS[0], markersize=4, label="random: N^(−1/2)")
        n, corners, midpoints = zip(*sample.grid_rows(integral, k, 2**16))
        axis.plot(n, corners, "s-", color=COLOURS[4], markersize=4, label=f"grid of corners: N^(−1/{k})")
        axis.plot(n, midpoints, "D-", color=COLOURS[1], markersize=4, label=f"grid of midpoints: N^(−2/{k})")
        style_axis(axis, xscale="log", yscale="log", xlabel="N", title=f"k = {k}", ylim=(1e-7, 2))
        axis.legend(frameon=False, fontsize=8, loc="lower left")
    axes[0].set_ylabel("error")
    save_figure(figure, folder / "grid_and_random.png")


def random_numbers(folder, images, reports):
    """A small corner of the unit square, so that single values show."""
    figure, axes = pyplot.subplots(1, 2, figsize=(8, 4.2), layout="constrained")
    for axis, name, title in zip(axes, ("numbers", "blog-hash"), ("PCG2D", "frac(sin(dot(p, …)) · 43758.5)")):
        playground = sample.PLAYGROUNDS[name]
        points = sample.draw(playground.sampler, 2**20, 0, 2)
        corner = points[(points < 1 / 32).all(axis=1)]
        axis.plot(corner[:, 0], corner[:, 1], ".", color=COLOURS[0], markersize=3, markeredgewidth=0)
        axis.set(title=f"{title}\n{len(corner):,} of {len(points):,} points", xlabel="u_x", ylabel="u_y")
        axis.set_aspect("equal")
    save_figure(figure, folder / "random_numbers.png")


def window(output, images, reports):
    """What the test of the window has seen: a chapter in it, and the same after a mistake was made in its shader."""
    command = ["tests/support/with_display.sh", BINARIES / "viewer_tests", "--gtest_filter=ViewerTest.ShowsThePicture*"]
    process = run_program(command)
    if process.returncode != 0 or "SKIPPED" in process.stdout:
        raise UserError("window: its test " + ("failed" if process.returncode != 0 else "needs Xvfb or a display"))
    for name in ("window.png", "window_broken_shader.png"):
        shutil.copyfile(ROOT / "output" / name, output / name)
