"""The tables of microfacets: what the ways to sample them cost, and what single scattering loses, from records of facet_record."""
from project import table
from report.numbers import Series, paired_ratio
from tables.cells import with_interval
from tables.records import load_records

WAYS_IN_WORDS = {"visible_normals": "visible normals", "normals": "any normals", "cosine": "the cosine"}
WAYS = list(WAYS_IN_WORDS)  # the first is what the others are compared with


def products(row, way):
    """Error × time of each run."""
    runs = row["ways"][way]
    return Series(dict(enumerate(error * seconds for error, seconds in zip(runs["errors"], runs["device_seconds"]))))


def sampling_cost(row, way):
    """[value, low, high] of error × time, relative to visible normals."""
    return paired_ratio(products(row, way), products(row, WAYS[0]))


def sampling_table():
    """Error × time of the other ways relative to visible normals, by roughness and device."""
    records = load_records("facets")
    columns = [(record, way) for record in records for way in WAYS[1:]]
    rows = [
        [f"{roughness:g}", *(with_interval(sampling_cost(record["sampling"][i], way)) for record, way in columns)]
        for i, roughness in enumerate(row["roughness"] for row in records[0]["sampling"])
    ]
    return table(["$P_r$", *(f"{WAYS_IN_WORDS[way]}, {record['device'].split(' (')[0]}" for record, way in columns)], rows)


def percent_lost(cell):
    """[% of the light, its standard error]"""
    return [100 * (1 - cell["reflected"]), 100 * cell["standard_error"]]


def lost_by_degrees(record):
    """What white metal loses: degrees -> rows by roughness, of single scattering alone and with the correction."""
    found = {}
    for row in record["furnace"]:
        found.setdefault(f"{row['degrees']:g}", []).append(
            {"roughness": row["roughness"], "single": percent_lost(row["single"]), "corrected": percent_lost(row["corrected"])}
        )
    return found


def furnace_table():
    """A column for each angle, and one for the largest loss or gain that the correction leaves."""
    lost = lost_by_degrees(load_records("facets")[0])
    rows = [
        [
            f"{cells[0]['roughness']:g}",
            *(f"{round(cell['single'][0], 1) + 0.0:.1f} %" for cell in cells),
            f"{max(abs(cell['corrected'][0]) for cell in cells):.2f} %",
        ]
        for cells in zip(*lost.values())
    ]
    return table(["$P_r$", *(f"lost, seen from {degrees}°" for degrees in lost), "left by the correction"], rows)
