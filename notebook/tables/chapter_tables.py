"""The tables of chapters and backends: what a sample costs, what error it has, and error × time relative to the chapter before."""
import math
from pathlib import Path

from project import UserError, scene_of, table
from report.numbers import errors, paired_ratio
from tables.best_table import among_chapters
from tables.cells import per_sample, with_interval, with_range
from tables.cost_tables import seconds_text
from tables.records import load_records, when


def kind_of(case):
    """Cases of the same kind and scene share a table: their names differ in the last word."""
    return case["case"].rpartition(" ")[0]


def kind_tables(record):
    """{(kind, scene): rows} for one device. A row starts with the name of its case."""
    tables, bases = {}, {}
    for case in record["cases"]:
        key = kind_of(case), case["scene"]
        rows = tables.setdefault(key, [])
        options = f"--samples {case['samples']} {case['options']}".strip()
        cost = [errors(case, key) for key in ("rays", "device_seconds")]
        rows.append(
            [
                case["case"],
                f"`{options}`",
                f"{per_sample(case, 'rays'):.3g}",
                seconds_text(per_sample(case, "device_seconds")),
                f"{case['samples'] * errors(case).mean:.3g}",
                *(with_interval(paired_ratio(*both)) if rows else "1" for both in zip(cost, bases.get(key, cost))),
            ]
        )
        if len(rows) == 1 or key[0] == "chapter":
            bases[key] = cost
    return tables


ALL_COLUMNS = " with all columns"  # suffix of a page's table; others have only the essential columns
COLUMNS = ["rays per sample", "time per sample", "error of one sample", "error × rays", "error × time"]


def chapter_tables(record):
    """The Markdown tables of one device."""
    environment = record["environment"]
    text = f"{environment['device']}, {environment['driver']}, backend `{record['cases'][0]['backend']}`.\n"
    sizes = {case["scene"]: case for case in record["cases"]}
    for (_, scene), rows in kind_tables(record).items():
        case = sizes[scene]
        text += f"\nScene `{Path(case['scene_file']).stem}`, {case['width']} x {case['height']} pixels:\n\n"
        text += table(["", "options", *COLUMNS], rows, left=2)
    return text


def page_table(name, record):
    """A page's table for one device: all cases of a kind, or for "chapter N" that chapter and the row before it."""
    name, is_wide = name.removesuffix(ALL_COLUMNS), name.endswith(ALL_COLUMNS)
    kind, _, number = name.partition(" ") if name.startswith("chapter ") else (name, "", "")
    tables, rows = kind_tables(record), []
    if kind not in {other for other, _ in tables}:
        raise UserError(f"there is no table '{name}': {', '.join(dict.fromkeys(other for other, _ in tables))}")
    for (other, scene), cases in tables.items():
        if other == kind:
            chosen = cases
            if number:
                # Only the very first case is shown without the row before it.
                places = [i for i, row in enumerate(cases) if row[0] == name and (i > 0 or name == record["cases"][0]["case"])]
                chosen = [row for i in places for row in cases[max(i - 1, 0) : i + 1]]
            if number and chosen:  # the other is compared with the first row
                chosen[0] = chosen[0][:-2] + ["1", "1"]
            rows += [
                [f"`{scene_of(scene)}`" if i == 0 else "", row[0], *row[2 if is_wide else -2 :]] for i, row in enumerate(chosen)
            ]
    return table(["scene", "", *(COLUMNS if is_wide else COLUMNS[-2:])], rows, left=2)


def expected_table():
    """Seconds and error in the Cornell box on each device, at the default resolution and number of samples."""
    rows, pixels, samples = [], 512 * 512, 64
    for record in load_records("chapters"):
        cases = [case for case in record["cases"] if kind_of(case) == "chapter" and case["scene"].startswith("cornell_box")]
        cells = []
        for case in cases:
            error = case["samples"] * errors(case).mean
            cells.append(
                f"{per_sample(case, 'device_seconds') * pixels * samples:.2g} s, {100 * math.sqrt(error / samples):.2g} %"
            )
        rows.append([record["environment"]["device"], *cells])
    text = table(["device", *(case["case"] for case in cases)], rows) + "\n"
    for record in load_records("backends"):
        rates = record["scenes"][0]["backends"]
        best = max(rates, key=lambda name: rates[name]["paths_per_second"])
        paths = rates[best]["paths_per_second"]
        text += (
            f"{record['device']}, `{best}`: {paths / 1e6:.0f} million paths per second in a Cornell box by next event estimation with Russian roulette. "
            f"The picture above takes {1e3 * pixels * samples / paths:.2g} ms.\n\n"
        )
    return text


def headline_table():
    """On each device, error × time of all chapters in the Cornell box, and how much faster the best one is."""
    devices, rows, text = [], {}, ""
    for record in load_records("chapters"):
        device = record["environment"]["device"]
        devices.append(device)
        scene = next(case["scene"] for case in record["cases"] if case["scene"].startswith("cornell_box"))
        chapters = kind_tables(record)["chapter", scene]
        for cells in chapters:
            rows.setdefault(cells[0], {})[device] = cells[-1]
        best, gain = next(texts for (scene, _, _), texts in among_chapters(record) if scene == "cornell_box")
        text += f"On {device}, {best} is {gain} times as fast as {chapters[0][0]} (measured on {when(record)}).\n"
    rows = [[name, *(cells.get(device, "") for device in devices)] for name, cells in rows.items()]
    return table(["error × time", *devices], rows) + "\n" + text


def over_bare(rates):
    """Rays per second relative to the bare rate: the median of interleaved runs and their range. Older records have a single
    number."""
    if "runs" not in rates:
        return f"{rates['rays_per_second'] / rates['bare_rays_per_second']:.2f}"
    ratios = [a / b for a, b in zip(rates["runs"]["rays_per_second"], rates["runs"]["bare_rays_per_second"])]
    return with_range(ratios)


def backend_table(record):
    """The Markdown table of one device."""
    head = [
        "scene",
        "triangles",
        "backend",
        "million paths/s",
        "million rays/s",
        "bare million rays/s",
        "rays/s over bare",
        "structure",
    ]
    rows = [
        [
            scene["scene"],
            f"{scene['triangles']:,}",
            f"`{name}`",
            f"{rates['paths_per_second'] / 1e6:.4g}",
            f"{rates['rays_per_second'] / 1e6:.4g}",
            f"{rates['bare_rays_per_second'] / 1e6:.4g}",
            over_bare(rates),
            f"{rates['structure_bytes'] / 2**20:.3g} MiB in {rates['structure_seconds']:.2g} s",
        ]
        for scene in record["scenes"]
        for name, rates in scene["backends"].items()
    ]
    return f"Driver {record['driver']}, Vulkan {record['api_version']}, {record['size']} x {record['size']} pixels.\n\n" + table(
        head, rows, left=3
    )
