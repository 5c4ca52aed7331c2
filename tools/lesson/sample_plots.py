"""Plots of points, their density and the estimates that they give."""
import matplotlib

matplotlib.use("agg")
import numpy as np
from matplotlib import pyplot
from report.plots import COLOURS, style_axis

SHOWN = 2000  # points in a scatter plot
DPI = 100


def scatter(axis, kind, points):
    """Points as they lie: numbers in their square, directions seen from above, barycentric coordinates in the plane."""
    points = points[:SHOWN]
    is_line = points.shape[1] == 1
    axis.plot(points[:, 0], np.arange(len(points)) if is_line else points[:, 1], ".", color=COLOURS[0], markersize=2.5, markeredgewidth=0)
    if kind == "disk":
        angle = np.linspace(0, 2 * np.pi, 200)
        axis.plot(np.cos(angle), np.sin(angle), color="#666666", linewidth=0.8)
    if kind == "triangle":
        axis.plot([0, 1, 0, 0], [0, 0, 1, 0], color="#666666", linewidth=0.8)
    if is_line:
        axis.set(xlabel="u", ylabel="index of the sample")
        return
    axis.set_aspect("equal")
    names = {"disk": ("ω_x", "ω_y"), "triangle": ("w_1", "w_2"), "square": ("u_x", "u_y")}[kind]
    axis.set(xlabel=names[0], ylabel=names[1])


def density(axis, playground, points, histogram):
    """Histogram of a coordinate, as a density, with the exact one."""
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
    pyplot.rcParams.update({"font.family": "sans-serif", "font.size": 10})
    figure, axes = pyplot.subplots(1, 3, figsize=(12, 3.8), layout="constrained")
    scatter(axes[0], playground.kind, points)
    density(axes[1], playground, points, histogram)
    for integral, colour in zip(playground.integrals, COLOURS):
        convergence(axes[2], estimates(integral.terms(points)), integral.value(dimensions), integral.formula, colour)
    style_axis(axes[2], xscale="log", xlabel="N")
    axes[2].legend(frameon=False, fontsize=8)
    figure.suptitle(playground.title, fontsize=11)
    figure.savefig(path, dpi=DPI)
    pyplot.close(figure)
