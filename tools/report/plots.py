"""Plots and pictures as SVG and PNG, with the colours of chapters."""
import base64
import io
import re

import matplotlib

matplotlib.use("svg")
import numpy as np
from matplotlib import image, pyplot, ticker

# Colours by Okabe and Ito, then by Tol, distinguishable by everybody; peers are grey. The numbers of colours and markers are
# coprime, so no two of 90 chapters look alike.
COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#332288", "#999933", "#882255", "#44aa99"]
PEER_COLOURS = ["#000000", "#666666", "#a0a0a0"]
MARKERS = "osD^vPX*<"
DIFFERENCE_FACTOR = 4  # of difference images: saturated means a difference of a quarter of the reference's mean
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
DPI = 100
GAP, LABEL = 4, 22  # pixels between tiles, height of a label
QUALITY = {"quality": 88, "optimize": True}  # of JPEG files


def style(case, index, peer_index):
    """Line, colour and marker, the same for a chapter in all plots."""
    if case["is_peer"]:
        return {"color": PEER_COLOURS[peer_index % len(PEER_COLOURS)], "linestyle": "--", "marker": "x"}
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": "-", "marker": MARKERS[index % len(MARKERS)]}


def style_axis(axis, **labels):
    axis.set(**labels)
    axis.grid(color="#888888", alpha=0.3, linewidth=0.8)
    axis.set_axisbelow(True)
    axis.spines[["top", "right"]].set_visible(False)


def save_figure(figure, path, dpi=100, **options):
    """Writes a figure to a file, creates its folder, and closes the figure."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=dpi, **options)
    pyplot.close(figure)


def plot_errors(scene, styles):
    """SVG: error against samples and against wall seconds, with 95 % bands."""
    pyplot.rcParams.update({"svg.fonttype": "none", "font.family": "sans-serif", "font.size": 13})
    figure, axes = pyplot.subplots(1, 2, figsize=(13, 5), sharey=True, layout="constrained")
    for axis, key, label in zip(axes, ("samples", "seconds"), ("samples per pixel", "seconds")):
        for case in scene["cases"]:
            points = [point for point in case["curve"] if point[key]]
            x, y = [point[key] for point in points], [point["error"] for point in points]
            axis.plot(x, [error[0] for error in y], label=case["case"], markersize=5, linewidth=1.8, **styles[case["case"]])
            if y and y[0][1]:
                axis.fill_between(
                    x,
                    [error[1] for error in y],
                    [error[2] for error in y],
                    alpha=0.2,
                    linewidth=0,
                    color=styles[case["case"]]["color"],
                )
        style_axis(axis, xscale="log", yscale="log", xlabel=label)
    axes[0].set_ylabel("error (rel_mse)")
    root = axes[1].secondary_yaxis("right", functions=(lambda e: 100 * np.sqrt(np.maximum(e, 0)), lambda e: (e / 100) ** 2))
    root.set_ylabel("its root")
    root.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
    root.yaxis.set_major_formatter(lambda percent, _: f"{percent:g} %")
    root.yaxis.set_minor_locator(ticker.NullLocator())
    axes[0].legend(frameon=False, fontsize=12)
    return svg_text(figure)


def svg_text(figure):
    """The <svg> element alone, without metadata."""
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={key: None for key in ("Creator", "Date", "Format", "Type")})
    pyplot.close(figure)
    return re.sub(r' (width|height)="[\d.]+pt"', "", stream.getvalue()[stream.getvalue().index("<svg") :], count=2)


def png_uri(pixels):
    """A data URI for an array [row, column, channel] of numbers in [0, 1]."""
    stream = io.BytesIO()
    image.imsave(stream, (255 * np.clip(pixels, 0, 1)).round().astype(np.uint8), format="png", pil_kwargs={"optimize": True})
    return "data:image/png;base64," + base64.b64encode(stream.getvalue()).decode()


def encode_srgb(radiance):
    """sRGB as in the chapters' PNG files: numbers in [0, 1]; anything brighter than white becomes 1."""
    linear = np.clip(radiance, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def picture(radiance):
    return png_uri(encode_srgb(radiance))


def relative_difference(radiance, reference):
    """The difference of each pixel's luminance, relative to the reference's mean."""
    return (radiance - reference) @ LUMINANCE / ((reference @ LUMINANCE).mean() or 1)


def difference_colours(difference, full=1 / DIFFERENCE_FACTOR):
    """Red where a pixel is too bright, blue where it is too dark, white where it is right; saturated at a difference of `full`.
    Numbers in [0, 1]."""
    excess = np.clip(difference / full, -1, 1)[:, :, None]
    red, blue = np.array([0.70, 0.09, 0.17]), np.array([0.13, 0.40, 0.67])
    return 1 - np.abs(excess) * (1 - np.where(excess > 0, red, blue))


def difference_picture(radiance, reference):
    return png_uri(difference_colours(relative_difference(radiance, reference)))


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
    """Two images side by side, and where the wrong one is too bright (red) or too dark (blue). Colours are as in a report, or
    weaker so that only one pixel in ten is saturated."""
    difference = relative_difference(wrong, right)
    full = max(1 / DIFFERENCE_FACTOR, np.quantile(np.abs(difference), 0.9))
    sheet(
        path,
        [
            [
                ("right", encode_srgb(right)),
                ("wrong", encode_srgb(wrong)),
                ("red: too bright, blue: too dark", difference_colours(difference, full)),
            ]
        ],
    )
