"""The backends of a CPU and Mitsuba's variants, from ./lab notebook report --record notebook/records/cpu/DEVICE.json --peer mitsuba."""
from project import scene_of, table
from report.numbers import errors, paired_ratio, short
from tables.cells import per_sample, with_interval

BASE = "Mitsuba LLVM"


def cpu_gains(record, clock):
    """{scene: {case: times faster than Mitsuba LLVM to the same error, with its interval}}. The clock is "seconds" of the wall, or
    "cpu_seconds" of all cores together."""
    found = {}
    for case in record["cases"]:
        found.setdefault(scene_of(case["scene"]), {})[case["case"]] = errors(case, clock)
    return {
        scene: {case: paired_ratio(series[BASE], of) for case, of in series.items() if case != BASE}
        for scene, series in found.items()
    }


def cpu_table(record):
    """The Markdown table of one CPU."""
    environment, by_wall, by_cpu, before, rows = (
        record["environment"],
        cpu_gains(record, "seconds"),
        cpu_gains(record, "cpu_seconds"),
        None,
        [],
    )
    for case in sorted(record["cases"], key=lambda case: case["scene"]):
        scene, name = scene_of(case["scene"]), case["case"]
        rows.append(
            [
                f"`{scene}`" if scene != before else "",
                name,
                short(1e-6 / per_sample(case, "seconds")),
                short(1e6 * per_sample(case, "cpu_seconds"), 2),
                short(case["samples"] * errors(case).mean, 2),
                *("1" if name == BASE else with_interval(times[scene][name]) for times in (by_wall, by_cpu)),
            ]
        )
        before = scene
    head = [
        "scene",
        "",
        "million samples/s",
        "CPU seconds per million samples",
        "error of one sample",
        f"times faster than {BASE}, wall time",
        "CPU time",
    ]
    return (
        f"{environment['processor']}, {environment['cores']} cores, {environment['device']}, and {environment['peer']}.\n\n"
        + table(head, rows, left=2)
    )
