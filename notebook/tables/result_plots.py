"""Draws the plots of docs/results.md from the records: SVG files that are legible on white and on black.

Each function of PLOTS returns a figure and the numbers that it shows. The file keeps a digest of these numbers, by which
`./lab notebook export --check` finds plots that are older than the records.
"""
import hashlib
import json
import re

from docs.page_plots import COLOURS, FONT, GREY, bars, finish_axis, lines, new_figure, plain, with_name
from matplotlib import pyplot, ticker
from project import read_json, scene_of, write_bytes
from report.numbers import Series, errors, paired_ratio, short
from report.plots import svg_text
from scipy.stats import binomtest
from tables.best_table import best_and_peers
from tables.confusion_table import CONDITIONS, rates
from tables.cpu_table import cpu_gains
from tables.facet_tables import WAYS, WAYS_IN_WORDS, lost_by_degrees, sampling_cost
from tables.filter_table import crossing
from tables.records import RECORDS, load_records
from tables.renderer_table import renderer_gains

ROW = 19  # height of a row with bars, in pixels


def devices(folder):
    """Name of a device -> its record."""
    return {record.get("device") or record["environment"]["device"]: record for record in load_records(folder)}


def short_device(name):
    """The device without its driver, and with what matters for its rays."""
    return name.split(" (")[0] + without_cores(name, " (without ray tracing cores)")


def without_cores(name, text):
    """The text if this device traces rays in software, else ""."""
    return text if re.search(r"\b[AH][12]00\b", name) else ""


def note_on_cores(names):
    """A line below an axis on those devices that trace rays in software, where a legend has no room for it."""
    return "".join(without_cores(name, f"\n{name}: without ray tracing cores") for name in names)


def forest(axis, rows, series):
    """One row per name, with a bar for each series {name of the row: [value, low, high]}. A row of None is a gap."""
    places = {name: -place for place, name in enumerate(rows) if name is not None}
    for index, (label, values) in enumerate(series.items()):
        offset = (index - (len(series) - 1) / 2) * -0.7 / len(series)
        bars(axis, [values.get(name) for name in places], [place + offset for place in places.values()], index, label)
    axis.set_yticks(list(places.values()), [name[-1] if isinstance(name, tuple) else name for name in places])
    axis.set_ylim(0.4 - len(rows), 0.6)


def legend_above(axis, columns, title=None):
    """A legend above the axis."""
    axis.legend(loc="lower center", bbox_to_anchor=(0.4, 1), ncols=columns, handletextpad=0.2, columnspacing=1, title=title)


def thousands(value, _=None):
    return next((f"{value / factor:g} {unit}" for factor, unit in ((1e6, "M"), (1e3, "k")) if value >= factor), f"{value:g}")


def cut_off(axis, low=None, high=None):
    """Ends a horizontal axis at a number, or before it. Points beyond get an arrow with their value at the end."""
    beyond = [(x, y, series[0].get_color()) for series in axis.containers for x, y in zip(*series[0].get_data())]
    axis.set_xlim(low, high)
    for x, y, colour in beyond:
        if low and x < low:
            axis.text(low, y, f" ◂ {short(x, 2)}", color=colour, va="center", fontsize=FONT - 3)
        elif high and x > high:
            axis.text(high, y, f"{short(x, 2)} ▸ ", color=colour, va="bottom", ha="right", fontsize=FONT - 3)


def panels(shown, row_height, columns, label, slow=None):
    """A forest of ratios for each title of {title: {row: {series: (value, low, high)}}}, one below the other. The axis ends with all
    other series than `slow`."""
    heights = [row_height * len(rows) + 85 for rows in shown.values()]
    figure, axes = new_figure(sum(heights), len(shown), sharex=True, squeeze=False, height_ratios=heights)
    for axis, (title, rows) in zip(axes[:, 0], shown.items()):
        names = dict.fromkeys(name for ratios in rows.values() for name in ratios)
        forest(axis, list(rows), {name: {row: ratios.get(name) for row, ratios in rows.items()} for name in names})
        axis.axvline(1, color=GREY, linewidth=1.5)
        finish_axis(axis, xscale="log")
        axis.xaxis.set_major_formatter(plain)
        legend_above(axis, columns, title)
    if slow:
        largest = max(
            high or value
            for rows in shown.values()
            for ratios in rows.values()
            for name, (value, _, high) in ratios.items()
            if name != slow
        )
        for axis in axes[:, 0]:
            cut_off(axis, high=2 * largest)
    axes[-1, 0].set_xlabel(label)
    return figure, axes[:, 0]


# ---------------------------------------------------------------------------------------------- the plots
def ideas():
    """Does each idea pay? Error × time of each chapter over that of the chapter before, by scene."""
    shown = {}
    for device, record in devices("chapters").items():
        before, values = {}, shown.setdefault(short_device(device), {})
        for case in record["cases"]:
            if not case["case"].startswith("chapter "):
                continue
            cost, scene = errors(case, "device_seconds"), scene_of(case["scene"])
            if scene in before:
                name, base = before[scene]
                values[f"{case['case'].removeprefix('chapter ')} over {name}", f"{scene}"] = paired_ratio(cost, base)
            before[scene] = case["case"].removeprefix("chapter "), cost
    steps = sorted(
        {step for values in shown.values() for step, _ in values}, key=lambda step: [int(n) for n in step.split(" over ")]
    )
    rows = []
    for step in steps:
        scenes = dict.fromkeys(row for values in shown.values() for row in values if row[0] == step)
        rows += [*scenes, None]
    figure, axis = new_figure(ROW * len(rows) + 90)
    forest(axis, rows[:-1], shown)
    for step in steps:
        inside = [-place for place, row in enumerate(rows) if row and row[0] == step]
        now, before = map(int, step.split(" over "))
        axis.text(
            1.02,
            (inside[0] + inside[-1]) / 2,
            f"{with_name(now)}\nover {with_name(before)}",
            transform=axis.get_yaxis_transform(),
            va="center",
            fontsize=FONT - 1,
        )
    axis.axvline(1, color=GREY, linewidth=1.5)
    finish_axis(axis, xscale="log", xlabel="error × time, relative to the chapter before (left of 1: it pays)")
    axis.xaxis.set_major_formatter(plain)
    cut_off(axis, low=0.01)
    legend_above(axis, 2)
    return figure, {device: [[*row, *value] for row, value in values.items()] for device, values in shown.items()}


def backends_of(grown):
    """Rays per second of a backend by triangles: {count: [million, low, high]}."""
    return {
        row["count"]: Series({i: row["rays_per_path"] * rate / 1e6 for i, rate in enumerate(row["paths_per_second"])}).interval()
        for row in grown["rows"]
    }


def backends():
    """Which backend is the fastest, by the number of triangles?"""
    found = devices("cost")
    shown = {
        short_device(device): {
            grown["backend"]: backends_of(grown) for grown in record["growth"] if grown["quantity"] == "triangles"
        }
        for device, record in found.items()
    }
    figure, axes = new_figure(300, columns=len(shown), squeeze=False)
    order = ["compute", "pipeline", "query", "native"]
    for axis, (device, by_name) in zip(axes[0], shown.items()):
        for name, values in by_name.items():
            index = order.index(name) if name in order else len(order)
            lines(axis, list(values), list(values.values()), index, name)
        finish_axis(axis, xscale="log", yscale="log", xlabel="triangles")
        axis.set_title(device.replace(" (", "\n("), fontsize=FONT)
        axis.yaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
        axis.yaxis.set_major_formatter(plain)
        axis.yaxis.set_minor_formatter(ticker.NullFormatter())
        axis.xaxis.set_major_formatter(thousands)
        axis.legend()
    axes[0][0].set_ylabel("million rays per second")
    return figure, {device: {name: list(values.items()) for name, values in by_name.items()} for device, by_name in shown.items()}


def mitsuba():
    """How many times faster than each variant and sampler of Mitsuba is our best chapter, by scene?"""
    shown = {}
    for device, record in devices("peers").items():
        if any(scene["gains"] for scene in record["scenes"]):
            shown[short_device(device)] = {
                f"{scene_of(scene['scene'])}, {scene['width']} × {scene['height']}": gains
                for scene, best, gains in best_and_peers(record)
            }
    figure, _ = panels(shown, 44, 2, "times faster than Mitsuba to the same error (right of 1: the chapter is)", "Mitsuba scalar")
    return figure, shown


def cpu_backends():
    """How many times faster than Mitsuba LLVM is each backend of a CPU, and each of Mitsuba's variants?"""
    shown = {
        f"{record['environment']['processor']}, {record['environment']['cores']} cores, {clock}": cpu_gains(record, key)
        for record in load_records("cpu")
        for clock, key in (("wall time", "seconds"), ("CPU time", "cpu_seconds"))
    }
    figure, axes = panels(shown, 60, 3, "times faster than Mitsuba LLVM to the same error (right of 1: it is faster)")
    for axis in axes:
        axis.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
        axis.xaxis.set_minor_formatter(ticker.NullFormatter())
    return figure, shown


def renderers():
    """How many times faster than other renderers is our best chapter, by scene and number of samples, in CPU time?"""
    (record,) = load_records("renderers")
    shown = {
        scene: {peer: {f"{samples} samples": ratio for samples, ratio in ratios.items()} for peer, ratios in peers.items()}
        for scene, peers in renderer_gains(record, "cpu_seconds").items()
    }
    figure, axes = panels(shown, 44, 4, "times that our chapter is faster to the same error, in CPU time (right of 1: it is)")
    for axis in axes:
        axis.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5)))
        axis.xaxis.set_minor_formatter(ticker.NullFormatter())
    return figure, shown


def features():
    """What does a feature of a scene cost on each backend? Time per path relative to the scene without it."""
    shown, rows = {}, []
    for device, record in devices("cost").items():
        for backend in record["features"]:
            base = backend["rows"][0]["paths_per_second"]
            rows = [row["feature"] for row in backend["rows"][1:]]
            shown[f"{backend['backend']}, {short_device(device).split(' (')[0]}"] = {
                row["feature"]: Series({i: a / b for i, (a, b) in enumerate(zip(base, row["paths_per_second"]))}).interval()
                for row in backend["rows"][1:]
            }
    figure, axis = new_figure(36 * len(rows) + 110)
    forest(axis, rows, shown)
    axis.axvline(1, color=GREY, linewidth=1.5)
    finish_axis(axis, xlabel="time per path, relative to the scene without the feature" + note_on_cores(devices("cost")))
    legend_above(axis, 3)
    return figure, shown


def check():
    """How often does ./lab check find a mistake, and name it?"""
    conditions = rates(read_json(RECORDS / "check/confusion.json"))
    rows = [words for key, words in CONDITIONS.items() if key in conditions]
    measures = {
        "large mistakes found": lambda rate: (rate.found_of_large, rate.large),
        "not silent": lambda rate: (rate.told, rate.found),
        "a single name is right": lambda rate: (rate.right, rate.alone),
        "refused though correct": lambda rate: (0, 0),
    }
    shown = {label: {} for label in measures}
    for key, words in CONDITIONS.items():
        rate = conditions.get(key)
        for label, counts in measures.items():
            count, of = counts(rate) if rate and key != "correct" else (0, 0)
            if key == "correct" and label == "refused though correct" and rate:
                count, of = rate.found, rate.tried
            if of:
                interval = binomtest(count, of).proportion_ci()
                shown[label][words] = [max(100 * count / of, 1e-9), 100 * interval.low, 100 * interval.high]
    figure, axis = new_figure(56 * len(rows) + 100)
    forest(axis, rows, shown)
    finish_axis(axis, xlabel="% of the trials", xlim=(-2, 102))
    legend_above(axis, 2)
    return figure, shown


def facets():
    """Left: what cosine and any normals cost, relative to visible normals. Right: what white metal loses, by the angle it is seen from."""
    found, shown = devices("facets"), {}
    for device, record in found.items():
        for way in WAYS[1:]:
            shown[f"{WAYS_IN_WORDS[way]}, {short_device(device).split(' (')[0]}"] = [
                [row["roughness"], sampling_cost(row, way)] for row in record["sampling"]
            ]
    lost = lost_by_degrees(next(iter(found.values())))
    figure, axes = new_figure(300, columns=2)
    for index, (label, rows) in enumerate(shown.items()):
        lines(axes[0], [roughness for roughness, _ in rows], [cost for _, cost in rows], index, label)
    axes[0].axhline(1, color=GREY, linewidth=1.5)
    finish_axis(axes[0], yscale="log", xlabel="roughness Pr" + note_on_cores(found), ylabel="error × time, visible normals are 1")
    axes[0].yaxis.set_major_formatter(plain)
    for index, (degrees, rows) in enumerate(lost.items()):
        axes[1].plot(
            [row["roughness"] for row in rows],
            [row["single"][0] for row in rows],
            color=COLOURS[index],
            label=f"seen from {degrees}°",
        )
    for index, rows in enumerate(lost.values()):  # they lie on one another
        axes[1].plot(
            [row["roughness"] for row in rows],
            [row["corrected"][0] for row in rows],
            "--",
            color=COLOURS[len(lost)],
            label=None if index else "corrected",
        )
    finish_axis(axes[1], xlabel="roughness Pr", ylabel="% of the light lost")
    legend_above(axes[0], 2)
    axes[1].legend()
    return figure, {"sampling": shown, "lost": lost}


PLOTS = {
    f"results_{draw.__name__}": draw for draw in (ideas, backends, mitsuba, cpu_backends, renderers, features, check, facets)
} | {"crossing": crossing}


# ---------------------------------------------------------------------------------------------- files
def digest(numbers):
    """Digest of a plot's numbers, to six digits: other versions of SciPy round the last ones differently."""
    text = json.dumps(numbers, default=str)
    return hashlib.sha256(re.sub(r"-?\d+\.\d+(?:e-?\d+)?", lambda match: f"{float(match[0]):.6g}", text).encode()).hexdigest()[
        :16
    ]


def write_plot(file, name):
    figure, numbers = PLOTS[name]()
    title = PLOTS[name].__doc__.split("\n")[0]
    text = svg_text(figure).replace(">", f">\n<title>{title}</title>\n<desc>numbers {digest(numbers)}</desc>", 1)
    write_bytes(file, text.encode())


def is_fresh(file, name):
    """Whether a plot shows the current numbers of the records."""
    figure, numbers = PLOTS[name]()
    pyplot.close(figure)
    return file.is_file() and f"<desc>numbers {digest(numbers)}</desc>" in file.read_text(encoding="utf-8")
