"""The comparison with Mitsuba in results/, from the report.json of ./lab notebook report --peer mitsuba."""
import math

from project import scene_of, table
from report.numbers import TARGET_ERROR, short
from tables.cells import with_interval


def gains_of(scene):
    """{(case, peer): how many times faster the case is, with its interval}."""
    return {(gain["case"], gain["peer"]): gain["gain"] for gain in scene["gains"]}


def samplers(scenes):
    """{peer: how many times faster it is than the same variant with independent samples, as geometric mean over the scenes}."""
    logarithms = {}
    for scene in scenes:
        for (case, peer), (value, _, _) in gains_of(scene).items():
            if case.startswith(f"{peer}, ") and value:
                logarithms.setdefault(case, []).append(math.log(value))
    return {case: math.exp(sum(values) / len(values)) for case, values in logarithms.items()}


def sampler_text(scenes):
    """Names the best of Mitsuba's samplers that were measured."""
    found = samplers(scenes)
    if not found:
        return "\nMitsuba's sampler is `independent`.\n"
    best = max(found, key=found.get)
    tried = ", ".join(f"{value:.2f} ({name.split(', ')[1]})" for name, value in found.items())
    name = best.split(", ")[1] if found[best] > 1 else "independent"
    return f"\nMitsuba's best sampler here is `{name}`. Times faster than `independent`, in the mean over the scenes: {tried}.\n"


def size_table(scenes):
    """The Markdown table for scenes of one size, with columns for Mitsuba with independent samples and with its best sampler."""
    cases = [case["case"] for scene in scenes for case in scene["cases"] if case["is_peer"]]
    found = samplers(scenes)
    best = max(found, key=found.get, default=None)
    peers = [case for case in dict.fromkeys(cases) if case not in found or case == best]
    head = [
        "scene",
        "",
        "million samples/s",
        "million paths/s",
        "error of one sample",
        *(f"times faster than {peer}" for peer in peers),
        f"seconds to {100 * TARGET_ERROR:.0f} % error",
        "of which start-up",
    ]
    rows = []
    for scene in scenes:
        gains = gains_of(scene)
        for number, case in enumerate(scene["cases"]):
            rows.append(
                [
                    f"`{scene_of(scene['scene'])}`" if number == 0 else "",
                    case["case"],
                    *(short(case[f"{what}_per_second"] / 1e6) for what in ("samples", "paths")),
                    short(case["error_of_one_sample"], 2),
                    *(with_interval(gains[case["case"], peer]) if (case["case"], peer) in gains else "" for peer in peers),
                    with_interval(case["seconds_to_target"]),
                    with_interval(case["start_up_seconds"]),
                ]
            )
    size = f"{scenes[0]['width']} x {scenes[0]['height']}"
    return f"\n{size} pixels:\n{sampler_text(scenes)}\n" + table(head, rows, left=2)


def peer_table(report):
    """The Markdown tables for one device."""
    sizes = {}
    for scene in report["scenes"]:
        if scene["gains"]:
            sizes.setdefault((scene["width"], scene["height"]), []).append(scene)
    environment, first = report["environment"], next(iter(sizes.values()))[0]["cases"][0]
    return f"{environment['device']}, `{first['backend']}`, and {environment['peer']}.\n" + "".join(
        map(size_table, sizes.values())
    )
