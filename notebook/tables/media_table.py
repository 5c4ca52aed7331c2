"""The table of chapter 13: what light samples gain in fog, from the records of media_strategies."""
from project import table
from report.numbers import Series, paired_ratio
from tables.cells import with_interval
from tables.records import load_records


def media_table():
    """Error times time of each strategy relative to both together."""

    def products(row, strategy):
        return Series(dict(enumerate(row["mse_times_cpu_seconds"][strategy])))

    return table(
        ["light in `fog`", "light samples alone", "bounces alone", "equiangular samples"],
        [
            [
                row["light"],
                *(
                    with_interval(paired_ratio(products(row, strategy), products(row, "both")))
                    for strategy in ("light", "bounces", "equiangular")
                ),
            ]
            for row in load_records("media")[0]["rows"]
        ],
    )
