"""The table of chapter 16: what filters gain at equal samples and at equal time, from the records of filters."""
from statistics import mean

from project import table
from tables.records import load_records

SHOWN = (4, 16, 64, 256, 1024)
NAMES = {"bilateral": "joint bilateral", "a_trous": "à-trous", "nl_means": "non-local means"}


def ratios(case, name):
    """Number of samples -> squared error of the filtered picture over that of the unfiltered one, and the same times seconds."""

    def means(runs):
        return {rows[0][0]: (mean(row[1] for row in rows), mean(row[2] for row in rows)) for rows in zip(*runs)}

    filtered, raw = means(case[name]), means(case["none"])
    errors = {samples: filtered[samples][0] / raw[samples][0] for samples in filtered}
    return errors, {samples: errors[samples] * filtered[samples][1] / raw[samples][1] for samples in filtered}


def cell(errors, costs, samples):
    """The error, and in brackets the cost to equal error; bold where the picture is worse than without a filter."""
    if samples not in errors:
        return "–"
    error = f"{errors[samples]:.2g}"
    return f"{f'**{error}**' if errors[samples] > 1 else error} ({costs[samples]:.2g})"


def filter_table():
    """For each scene and filter, at several numbers of samples."""
    return table(
        ["device", "scene", "filter", *(f"{samples:,} samples" for samples in SHOWN)],
        [
            [
                "CPU" if record["backend"] == "native" else record["device"],
                f"`{case['scene']}`",
                text,
                *(cell(*ratios(case, name), samples) for samples in SHOWN),
            ]
            for record in load_records("filters")
            for case in record["cases"]
            for name, text in NAMES.items()
        ],
    )
