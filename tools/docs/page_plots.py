"""Plots for the pages: SVG files as wide as a page, legible on white and on black. Intervals hold with a probability of 95 %."""
from matplotlib import pyplot
from project import CHAPTERS, description

GREY = "#787d83"
# Blue, orange, purple, green, pink, teal, olive and red: visible on white and on black, and distinguishable by their markers. Grey is for
# axes.
COLOURS, MARKERS = ["#2f7de1", "#c96a00", "#9b62d6", "#2c8f4e", "#d6408f", "#0b93a3", "#8c7a00", "#d64545"], "osD^XvP*"
WIDTH, FONT = 640, 12  # pixels: width of a plot, font size
STYLE = {
    "svg.fonttype": "none",
    "svg.hashsalt": "lab",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana"],
    "font.size": FONT,
    "figure.constrained_layout.w_pad": 0.16,
    "savefig.transparent": True,
    "legend.frameon": False,
    "legend.fontsize": FONT - 1,
} | {f"{name}color": GREY for name in ("text.", "axes.edge", "axes.label", "xtick.", "ytick.", "grid.")}


def new_figure(height, rows=1, columns=1, **options):
    """A figure as wide as the pages; lengths are in pixels."""
    pyplot.rcParams.update(STYLE)
    return pyplot.subplots(rows, columns, figsize=(WIDTH / 72, height / 72), layout="constrained", **options)


def finish_axis(axis, **labels):
    axis.set(**labels)
    axis.grid(linewidth=0.5, alpha=0.5)
    axis.set_axisbelow(True)
    axis.spines[["top", "right"]].set_visible(False)


def bars(axis, values, places, index, label, is_horizontal=True):
    """Points [value, low, high] with their intervals; those without a value are left out."""
    shown = [(place, value) for place, value in zip(places, values) if value and value[0]]
    x = [value[0] for _, value in shown]
    spread = [
        [value[0] - (value[1] or value[0]) for _, value in shown],
        [(value[2] or value[0]) - value[0] for _, value in shown],
    ]
    y = [place for place, _ in shown]
    data, error = ((x, y), {"xerr": spread}) if is_horizontal else ((y, x), {"yerr": spread})
    axis.errorbar(
        *data, **error, fmt=MARKERS[index], color=COLOURS[index], markersize=5, elinewidth=1.6, capsize=2.5, label=label
    )


def lines(axis, x, values, index, label):
    """A line with bars."""
    bars(axis, values, x, index, None, is_horizontal=False)
    axis.plot(
        x, [value[0] for value in values], color=COLOURS[index], marker=MARKERS[index], markersize=5, linewidth=1.2, label=label
    )


def with_name(number):
    """A chapter as its number and name."""
    return f"{number} {description(CHAPTERS[number])['title'].partition(':')[0]}"


def plain(value, _=None):
    return f"{value:,.0f}" if value >= 1 else f"{value:g}"
