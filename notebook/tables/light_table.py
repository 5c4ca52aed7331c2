"""The table of chapter 14: what the tree over emissive triangles gains, from the records of light_choices."""
import math

from project import table
from report.numbers import Series, paired_ratio
from tables.cells import with_interval
from tables.records import load_records


def light_table():
    """What each device says of other ways to choose a lamp, relative to the tree: their error, time and the product of both."""

    def series(row, choice, *keys):
        return Series(dict(enumerate(map(math.prod, zip(*(row[choice][key] for key in keys))))))

    def cells(row, choice):
        for keys in (["rel_mse"], ["seconds"], ["rel_mse", "seconds"]):
            yield with_interval(paired_ratio(series(row, choice, *keys), series(row, "tree", *keys)))

    return table(
        ["device", "scene", "instead of the tree", "error", "time", "error × time"],
        [
            ["CPU" if record["backend"] == "native" else record["device"], f"`{row['scene']}`", title, *cells(row, choice)]
            for record in load_records("lights")
            for row in record["rows"]
            for choice, title in (("power", "by power"), ("uniform", "all alike"))
        ],
    )
