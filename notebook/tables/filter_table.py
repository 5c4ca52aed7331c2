"""Chapter 16: what filters gain at equal samples, as a plot, and at equal time, as a table, from the records of filters."""
from statistics import mean

from docs.page_plots import COLOURS, GREY, MARKERS, finish_axis, new_figure, plain
from project import table
from tables.records import load_records

SHOWN = (16, 1024)
NAMES = {"bilateral": "joint bilateral", "a_trous": "à-trous", "nl_means": "non-local means"}


def ratios(case, name):
    """Number of samples -> squared error of the filtered picture over that of the unfiltered one, and the same times seconds."""

    def means(runs):
        return {rows[0][0]: (mean(row[1] for row in rows), mean(row[2] for row in rows)) for rows in zip(*runs)}

    filtered, raw = means(case[name]), means(case["none"])
    errors = {samples: filtered[samples][0] / raw[samples][0] for samples in filtered}
    return errors, {samples: errors[samples] * filtered[samples][1] / raw[samples][1] for samples in filtered}


def bold_above_1(ratio):
    return f"**{ratio:.2g}**" if ratio > 1 else f"{ratio:.2g}"


def filter_table():
    """For each scene and filter, at several numbers of samples: error times time over that of the unfiltered picture."""
    return table(
        ["device", "scene", *(f"{text}, {samples:,} samples" for text in NAMES.values() for samples in SHOWN)],
        [
            [
                "CPU" if record["backend"] == "native" else record["device"],
                f"`{case['scene']}`",
                *(bold_above_1(ratios(case, name)[1][samples]) for name in NAMES for samples in SHOWN),
            ]
            for record in load_records("filters")
            for case in record["cases"]
        ],
    )


def network_table():
    """For each scene: the squared error of a network's picture over that of the filter's, at several numbers of samples."""
    counts = sorted({case["samples"] for record in load_records("network") for case in record["cases"]})

    def cells(cases, scene):
        yield f"`{scene}`"
        for count in counts:
            case = next(case for case in cases if (case["scene"], case["samples"]) == (scene, count))
            yield f"{mean(case['network']) / mean(case['filter']):.2g}"

    return table(
        ["scene", *(f"{count:,} samples" for count in counts)],
        [
            list(cells(record["cases"], scene))
            for record in load_records("network")
            for scene in dict.fromkeys(case["scene"] for case in record["cases"])
        ],
    )


def crossing():
    """Squared error of filtered pictures over that of unfiltered ones, against samples per pixel"""
    figure, axes = new_figure(300, columns=3, sharey=True)
    cases = load_records("filters")[0]["cases"]
    shown = {(name, case["scene"]): ratios(case, name)[0] for name in NAMES for case in cases}
    for axis, (name, text) in zip(axes, NAMES.items()):
        axis.axhline(1, color=GREY, linewidth=1.2)
        for index, case in enumerate(cases):
            errors = shown[name, case["scene"]]
            style = {"color": COLOURS[index], "marker": MARKERS[index], "markersize": 5, "linewidth": 1.2}
            axis.plot(list(errors), list(errors.values()), **style, label=case["scene"])
        finish_axis(axis, xscale="log", yscale="log", xlabel="samples per pixel", title=text, ylim=(0.05, 20))
        axis.xaxis.set_major_formatter(plain)
        axis.yaxis.set_major_formatter(plain)
    axes[0].set_ylabel("error² over that of no filter")
    axes[2].legend(loc="upper right")
    return figure, {" ".join(key): list(errors.items()) for key, errors in shown.items()}
