"""The table of chapter 17: what a derivative costs, from the records of derivatives."""
import math

from project import table
from report.numbers import Series, paired_ratio
from tables.cells import with_interval
from tables.records import load_records


def derivative_table():
    """For each material: errors relative to the mean derivative, and how much more error × time the differences have."""

    def series(numbers):
        return Series(dict(enumerate(map(math.prod, zip(numbers["mse"], numbers["seconds"])))))

    def error(numbers):
        return f"{100 * math.sqrt(sum(numbers['mse']) * len(numbers['mse'])) / abs(sum(numbers['mean'])):.3g} %"

    return table(
        [
            "device",
            "albedo",
            "error of the derivative",
            "error of a difference",
            "cost of a difference",
            "with other random numbers",
        ],
        [
            [
                "CPU" if record["backend"] == "native" else record["device"],
                row["material"],
                error(row["derivative"]),
                error(row["difference"]),
                *(
                    with_interval(paired_ratio(series(row[way]), series(row["derivative"])))
                    for way in ("difference", "other_numbers")
                ),
            ]
            for record in load_records("derivatives")
            for row in record["rows"]
        ],
    )
