"""What docs/results.md shows of Mitsuba and us: the report.json of ./lab report --peer mitsuba."""
from project import table
from report.numbers import TARGET_ERROR, short, with_interval

HEADER = f"""
## Against Mitsuba

The chapters and Mitsuba 3 render the same scenes on the same machine in turns (`./lab report --peer mitsuba cornell_box
heart_light glass 3 5 6`; the record is its `report.json`). The error is that of the first section. "Times faster" is the quotient of
the times to the same error, by the clock and for rendering alone; seconds to {100 * TARGET_ERROR:.0f} % error are those from the command to a
picture whose relative root mean squared error is that, with start-up. In brackets: the 95 % confidence interval.

What limits: `heart_light` is lit from nearby, where light sampling alone is noisy; Mitsuba combines it with BSDF sampling
(multiple importance sampling), which these chapters leave out, and so needs fewer samples. On the CPU its LLVM variant traces eight
rays at a time with Embree. On a GPU our threads wait for the longest path of their group
([backends.md](backends.md#when-each-is-faster-and-what-limits-it)).
"""


def peer_table(report):
    """The Markdown table of one device."""
    scenes = [scene for scene in report["scenes"] if scene["gains"]]
    peers = list(dict.fromkeys(gain["peer"] for scene in scenes for gain in scene["gains"]))
    head = ["scene", "", "million paths/s", "error of one sample", *(f"times faster than {peer}" for peer in peers),
            f"seconds to {100 * TARGET_ERROR:.0f} % error", "of which start-up"]
    rows = []
    for scene in scenes:
        gains = {(gain["case"], gain["peer"]): with_interval(gain["gain"]) for gain in scene["gains"]}
        for number, case in enumerate(scene["cases"]):
            rows.append([f"`{scene['scene'].rstrip('_0123456789')}`" if number == 0 else "", case["case"],
                         f"{case['paths_per_second'] / 1e6:.3g}", short(case["error"][0] * case["samples"], 2),
                         *(gains.get((case["case"], peer), "") for peer in peers),
                         with_interval(case["seconds_to_target"]), with_interval(case["start_up_seconds"])])
    environment, first = report["environment"], scenes[0]["cases"][0]
    size = f"{scenes[0]['width']} x {scenes[0]['height']}"
    return (f"\n### {environment['device']}, `{first['backend']}`\n\n{environment['peer']}, {size} pixels.\n\n"
            + table(head, rows, left=2))
