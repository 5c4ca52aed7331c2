"""Plots of points, their density and the resulting estimates."""
import matplotlib

matplotlib.use("agg")
import numpy as np
from lesson import point_sets
from matplotlib import pyplot
from report.plots import COLOURS, MARKERS, save_figure, style_axis

SHOWN = 2000  # points in a scatter plot


def scatter(axis, kind, points):
    """Scatter plot: numbers in their square, directions seen from above, barycentric coordinates in the plane."""
    points = points[:SHOWN]
    is_line = points.shape[1] == 1
    axis.plot(
        points[:, 0],
        np.arange(len(points)) if is_line else points[:, 1],
        ".",
        color=COLOURS[0],
        markersize=2.5,
        markeredgewidth=0,
    )
    if kind in ("disk", "aperture"):
        angle = np.linspace(0, 2 * np.pi, 200)
        axis.plot(np.cos(angle), np.sin(angle), color="#666666", linewidth=0.8)
    if kind == "triangle":
        axis.plot([0, 1, 0, 0], [0, 0, 1, 0], color="#666666", linewidth=0.8)
    if is_line:
        axis.set(xlabel="u", ylabel="index of the sample")
        return
    axis.set_aspect("equal")
    names = {"disk": ("ω_x", "ω_y"), "aperture": ("x", "y"), "triangle": ("w_1", "w_2"), "square": ("u_x", "u_y")}[kind]
    axis.set(xlabel=names[0], ylabel=names[1])


def density(axis, playground, points, histogram):
    """Histogram of a coordinate as a density, with the exact density."""
    edges, counts, _ = histogram(playground, points)
    heights = counts / counts.sum() / np.diff(edges)
    axis.stairs(heights, edges, fill=True, color=COLOURS[5], label="points")
    fine = np.linspace(0, 1, 401)
    axis.plot((fine[1:] + fine[:-1]) / 2, np.diff(playground.cumulative(fine)) / np.diff(fine), color=COLOURS[4], label="density")
    style_axis(axis, xlabel=playground.coordinate, ylim=(0, 1.35 * heights.max()))
    axis.legend(frameon=False)


def convergence(axis, rows, exact, label, colour):
    """Estimates with error bars against N."""
    n, mean, half = np.array(rows).T
    axis.errorbar(n, mean, np.nan_to_num(half), fmt="o", markersize=4, capsize=3, color=colour, label=label)
    axis.axhline(exact, color=colour, linewidth=1)


def save_overview(path, playground, points, dimensions, histogram, estimates):
    """Points, density and estimates side by side."""
    figure, axes = pyplot.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
    scatter(axes[0], playground.kind, points)
    density(axes[1], playground, points, histogram)
    for integral, colour in zip(playground.integrals, COLOURS):
        convergence(axes[2], estimates(integral.terms(points)), integral.value(dimensions), integral.formula, colour)
    style_axis(axes[2], xscale="log", xlabel="N")
    axes[2].legend(frameon=False, fontsize=8)
    figure.suptitle(playground.title, fontsize=11)
    save_figure(figure, path)


def save_point_sets(path, sets, integrals):
    """Point sets, their spectra, and the errors of two integrals with them."""
    names = ["grid", *sets]
    figure = pyplot.figure(figsize=(14, 6), layout="constrained")
    axes = figure.add_gridspec(2, len(names) + 1, width_ratios=[1] * len(names) + [1.5])
    shown, reach = point_sets.SPECTRUM_SIZE, point_sets.FREQUENCIES
    for column, (name, power) in enumerate(point_sets.spectra(sets).items()):
        points = figure.add_subplot(axes[0, column], title=f"{name}, {shown} points")
        points.plot(*point_sets.first_points(sets, name, shown)[0].T, ".", color=COLOURS[0], markersize=4, markeredgewidth=0)
        points.set(aspect="equal", xlim=(0, 1), ylim=(0, 1), xticks=[], yticks=[])
        figure.add_subplot(axes[1, column], title="spectrum" + (", mean of pixels" if column else ""), xlabel="frequency").imshow(
            power, cmap="gray", vmin=0, vmax=2, extent=[-reach, reach, -reach, reach], interpolation="nearest"
        )
    for row, (title, integral) in enumerate(integrals.items()):
        axis = figure.add_subplot(axes[row, -1])
        for (name, errors), colour, marker in zip(point_sets.errors(sets, integral).items(), COLOURS, MARKERS):
            axis.plot(point_sets.SIZES, errors, marker + "-", color=colour, markersize=4, label=name)
        style_axis(axis, xscale="log", yscale="log", title=f"error of {title}", xlabel="N" if row else None)
        axis.legend(frameon=False, fontsize=8)
    save_figure(figure, path)
