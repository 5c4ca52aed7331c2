"""The table of chapter 14: what the tree over emissive triangles gains, from the records of light_choices."""
from project import table
from report.numbers import Series, paired_ratio, with_interval
from tables.records import load_records


def light_table():
    """Error, time and their product of other ways to choose a lamp, relative to the tree."""
    def series(row, choice, *keys):
        runs = zip(*(row[choice][key] for key in keys))
        return Series({run: numbers[0] * (numbers[1] if len(numbers) > 1 else 1) for run, numbers in enumerate(runs)})

    def cells(row, choice):
        for keys in (["rel_mse"], ["cpu_seconds"], ["rel_mse", "cpu_seconds"]):
            yield with_interval(paired_ratio(series(row, choice, *keys), series(row, "tree", *keys)))

    return table(["scene", "instead of the tree", "error", "time", "error × time"],
                 [[f"`{row['scene']}`", title, *cells(row, choice)]
                  for row in load_records("lights")[0]["rows"] for choice, title in (("power", "by power"), ("uniform", "all alike"))])
