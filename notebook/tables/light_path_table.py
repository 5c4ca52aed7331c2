"""The table of chapter 15: what light paths gain, from the records of light_paths."""
import math

from project import table
from report.numbers import Series, paired_ratio
from tables.cells import with_interval
from tables.records import load_records


def light_path_table():
    """For each lamp: the error of both chapters where the camera sees no glass, and how much less error × time chapter 15 has."""

    def series(row, chapter, *keys):
        return Series(dict(enumerate(map(math.prod, zip(*(row[chapter][key] for key in keys))))))

    def cells(row):
        for chapter in ("camera", "both"):
            yield f"{sum(row[chapter]['rel_mse_of_matte']) / len(row[chapter]['rel_mse_of_matte']):.2g}"
        for error in ("rel_mse_of_matte", "rel_mse"):
            yield with_interval(paired_ratio(series(row, "camera", error, "seconds"), series(row, "both", error, "seconds")))

    return table(
        [
            "device",
            "side of the lamp",
            "relMSE of chapter 14",
            "relMSE of chapter 15",
            "gain where no glass is seen",
            "gain of the picture",
        ],
        [
            ["CPU" if record["backend"] == "native" else record["device"], f"{row['side']:g}", *cells(row)]
            for record in load_records("light_paths")
            for row in record["rows"]
        ],
    )
