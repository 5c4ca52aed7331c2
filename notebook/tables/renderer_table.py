"""Our best chapter beside other renderers, from ./lab notebook renderers --record notebook/records/renderers/DEVICE.json."""
from peers.compare import COUNTS, PEERS
from project import scene_of, table
from report.numbers import biases, errors, paired_ratio, runs_in_batches, short
from tables.cells import with_interval

CLOCKS = {"CPU time": "cpu_seconds", "wall time": "seconds"}


def by_scene(record):
    """{scene: (our case, cases of the other renderers)}."""
    scenes = {}
    for case in record["cases"]:
        if case["runs"]:
            scenes.setdefault(scene_of(case["scene"]), []).append(case)
    return {
        scene: (next(case for case in cases if not case["is_peer"]), [case for case in cases if case["is_peer"]])
        for scene, cases in scenes.items()
    }


def renderer_gains(record, clock):
    """{scene: {renderer: {samples: times that our chapter is faster to the same error, with its interval}}}."""

    def gains(peer, ours):
        counts = COUNTS[: len(ours["runs"][0]["rows"])]
        return {
            samples: paired_ratio(errors(peer, clock, index), errors(ours, clock, index)) for index, samples in enumerate(counts)
        }

    return {scene: {peer["case"]: gains(peer, ours) for peer in peers} for scene, (ours, peers) in by_scene(record).items()}


def difference(case, comparisons):
    """From the mean of the reference, in the channel that is least sure to be right. Each run counts with its last picture."""
    runs = [{"rows": run["rows"][-1:]} for run in case["runs"]] if case["is_peer"] else runs_in_batches(case)
    worst = max(biases(runs, case["reference"], comparisons), key=lambda channel: abs(channel["value"]) / channel["half_width"])
    return f"{100 * worst['value']:+.3f} ± {100 * worst['half_width']:.3f} %" + (" (biased)" if worst["is_biased"] else "")


def per_sample(case, index):
    """[error of one sample, CPU seconds of a million samples] of the pictures with this index."""
    rows = [run["rows"][index] for run in case["runs"]]
    error = sum(row["samples"] * row["rel_mse"] for row in rows) / len(rows)
    cost = sum(row["cpu_seconds"] / row["samples"] for row in rows) / len(rows) / (case["width"] * case["height"])
    return [short(error, 2), short(1e6 * cost, 2)]


def gain_texts(gains, case, is_ours):
    """A cell for each number of samples; those that a scene lacks are empty."""
    counts = next(iter(gains.values()))
    return [
        "" if samples not in counts else "1" if is_ours else with_interval(gains[case["case"]][samples]) for samples in COUNTS
    ]


def left_out(record):
    """A sentence for each renderer and scene that it cannot render."""
    refusals = dict.fromkeys((scene_of(case["scene"]), case["refused"]) for case in record["cases"] if case["refused"])
    return "".join(f"\nNot in `{scene}`: {refused}.\n" for scene, refused in refusals)


def renderer_table(record):
    """The Markdown tables of one CPU, the first with what differs between renderers, and one for each clock."""
    scenes, environment = by_scene(record), record["environment"]
    comparisons = 3 * sum(1 + len(peers) for _, peers in scenes.values())
    names = ", ".join(dict.fromkeys(name for case, name in environment["renderers"].items() if case in PEERS))
    text = f"{environment['processor']}, {environment['cores']} cores, and {names}.\n"

    def rows(cells):
        return [
            [f"`{scene}`" if case is ours else "", case["case"], *cells(scene, case, case is ours)]
            for scene, (ours, peers) in scenes.items()
            for case in (ours, *peers)
        ]

    def numbers(_, case, is_ours):
        return [*per_sample(case, COUNTS.index(64)), per_sample(case, COUNTS.index(256))[0], difference(case, comparisons)]

    head = [
        "scene",
        "",
        "error of one sample at 64",
        "CPU seconds per million samples",
        "error of one sample at 256",
        "mean minus the reference's",
    ]
    text += "\n" + table(head, rows(numbers), left=2)
    for clock, key in CLOCKS.items():
        gains = renderer_gains(record, key)
        head = ["scene", f"ours faster in {clock}", *(f"{samples} samples" for samples in COUNTS)]
        text += "\n" + table(head, rows(lambda scene, case, is_ours, of=gains: gain_texts(of[scene], case, is_ours)), left=2)
    return text + left_out(record)
