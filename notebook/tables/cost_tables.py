"""The part of results/ about the cost of features and its growth, from records of cost_record."""
import math
from statistics import linear_regression, median

from project import table
from tables.cells import with_range

UNITS = ["bytes", "KiB", "MiB", "GiB"]


def bytes_text(count):
    unit = min(int(math.log(max(count, 1), 1024)), len(UNITS) - 1)
    return f"{count / 1024**unit:.3g} {UNITS[unit]}" if unit else f"{count} bytes"


def seconds_text(seconds):
    for factor, unit in ((1, "s"), (1e3, "ms"), (1e6, "µs")):
        if seconds * factor >= 1:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def time_text(row, base):
    """Time per path relative to that of the row `base`."""
    if row is base:
        return f"1 = {seconds_text(1 / median(row['paths_per_second']))}"
    return with_range([b / a for a, b in zip(row["paths_per_second"], base["paths_per_second"])])


def device_line(record):
    return (
        f"Driver {record['driver']}, Vulkan {record['api_version']}, {record['cpu_threads']} "
        f"threads of the CPU, {record['size']} x {record['size']} pixels.\n"
    )


def feature_table(record):
    """The cost of each feature on a device, with two columns for each backend."""
    measured = record["features"]
    head = ["", "buffers"]
    for backend in measured:
        head += [f"`{backend['backend']}`: instructions", "time per path"]
    rows = []
    for i, row in enumerate(measured[0]["rows"]):
        bare = measured[0]["rows"][0]["bytes"] if i else {}
        cells = [row["feature"], buffers_text({name: count for name, count in row["bytes"].items() if bare.get(name) != count})]
        for backend in measured:
            cells += [str(backend["rows"][i]["instructions"]), time_text(backend["rows"][i], backend["rows"][0])]
        rows.append(cells)
    return device_line(record) + "\n" + table(head, rows, left=2) + "\n" + scene_table(record)


def buffers_text(sizes):
    return ", ".join(f"{name} {bytes_text(count)}" for name, count in sizes.items())


def scene_table(record):
    """The memory that the shipped scenes take."""
    rows = [
        [f"`{scene['scene']}`", buffers_text(scene["bytes"]), f"{scene['triangles']:,}", f"{scene['instances']:,}"]
        for scene in record["scenes"]
    ]
    return "The shipped scenes:\n\n" + table(["scene", "buffers", "triangles", "instances"], rows, left=2)


def memory_of(row):
    return sum(row["bytes"].values()) + row["structure_bytes"] + row["film_bytes"]


def exponent(rows, quantity):
    """Slope in log-log coordinates, for quantities above 0."""
    counts = [math.log(row["count"]) for row in rows]
    if len(rows) < 2:
        return "-"
    slope = linear_regression(counts, [math.log(quantity(row)) for row in rows]).slope
    return f"{round(slope, 2) + 0.0:.2f}"  # never -0.00


def growth_table(measured):
    """How the cost grows with one quantity, on all backends of a device."""
    first = measured[0]
    grows = memory_of(first["rows"][0]) != memory_of(first["rows"][-1])
    builds = first["rows"][0]["structure_bytes"] != first["rows"][-1]["structure_bytes"]
    head = [first["quantity"], "rays per path"]
    rows = [[f"{row['count']:,}", f"{row['rays_per_path']:.3g}"] for row in first["rows"]]
    slopes = ["exponent", exponent(first["rows"], lambda row: row["rays_per_path"])]
    for backend in measured:
        base = backend["rows"][0]
        columns = [("time per path", lambda row: 1 / median(row["paths_per_second"]), lambda row: time_text(row, base))]
        if grows:
            columns.append(("memory", memory_of, lambda row: bytes_text(memory_of(row))))
        if builds:
            columns.append(
                ("structure built in", lambda row: row["structure_seconds"], lambda row: seconds_text(row["structure_seconds"]))
            )
        for number, (name, quantity, text) in enumerate(columns):
            head.append(name if number else f"`{backend['backend']}`: {name}")
            slopes.append(exponent(backend["rows"], quantity))
            for cells, row in zip(rows, backend["rows"]):
                cells.append(text(row))
    chapter = f"Chapter {int(first['chapter'][:2])}:\n\n"
    return chapter + table(head, rows + [slopes], left=0)


def growth_tables(record):
    text = device_line(record)
    for quantity in dict.fromkeys(growth["quantity"] for growth in record["growth"]):
        text += "\n" + growth_table([growth for growth in record["growth"] if growth["quantity"] == quantity])
        if quantity == "triangles":
            text += build_rate(record)
    return text


def build_rate(record):
    """How fast our own tree is built, measured in the largest scene."""
    for growth in record["growth"]:
        if growth["quantity"] == "triangles" and growth["backend"] == "compute":
            row = growth["rows"][-1]
            return (
                f"\n`compute` builds its tree on the CPU: {row['count'] / row['structure_seconds'] / 1e6:.3g} million triangles "
                f"per second with {record['cpu_threads']} threads.\n"
            )
    return ""
