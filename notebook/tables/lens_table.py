"""The table of chapter 12: what two separate points for pixel and lens cost, and the polar map, from the records of lens_points."""
from project import table
from report.numbers import Series, paired_ratio
from tables.cells import with_interval
from tables.records import load_records


def lens_table():
    """Mean squared error of other ways relative to the chapter's, by the diameter of the aperture and the number of samples."""
    rows = load_records("lens")[0]["rows"]
    counts = list(rows[0]["joint"][0])[::2]

    def errors(row, way, samples):
        return Series({run: found[samples] for run, found in enumerate(row[way])})

    return table(
        ["instead", "aperture diameter", *(f"{samples} samples" for samples in counts)],
        [
            [
                title,
                f"{row['aperture_diameter']:g}",
                *(with_interval(paired_ratio(errors(row, way, samples), errors(row, "joint", samples))) for samples in counts),
            ]
            for way, title in (("padded", "two points"), ("polar", "polar map"))
            for row in rows
        ],
    )
