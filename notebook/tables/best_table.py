"""For each scene, the chapter that reaches a given error in the least time."""
from project import scene_of, table
from report.numbers import errors, paired_ratio
from tables.cells import with_interval
from tables.peer_table import gains_of
from tables.records import load_records


def among_chapters(record):
    """[best chapter, its gain over the first one] of each scene and size of a device, from a record of chapters."""
    scenes = {}
    for case in record["cases"]:
        if case["case"].startswith("chapter ") and errors(case, "device_seconds").mean > 0:
            scenes.setdefault((scene_of(case["scene"]), case["width"], case["height"]), []).append(case)
    for key, cases in scenes.items():
        first, best = errors(cases[0], "device_seconds"), min(cases, key=lambda case: errors(case, "device_seconds").mean)
        yield key, [best["case"], "1" if best is cases[0] else with_interval(paired_ratio(first, errors(best, "device_seconds")))]


def best_and_peers(record):
    """(scene, best chapter, {peer: its gain over it}) of each scene and size of a device, from a record of peers."""
    for scene in record["scenes"]:
        ours = {pair: gain for pair, gain in gains_of(scene).items() if gain[0] and pair[0].startswith("chapter ")}
        if ours:
            best = max(ours, key=lambda pair: ours[pair][0])[0]  # the same against all peers
            yield scene, best, {peer: gain for (case, peer), gain in ours.items() if case == best}


def against_peers(record):
    """[best chapter, Mitsuba at its best, gain over that] of each scene and size of a device: the peer over which it gains least."""
    for scene, best, gains in best_and_peers(record):
        peer = min(gains, key=lambda peer: gains[peer][0])
        yield (scene_of(scene["scene"]), scene["width"], scene["height"]), [best, peer, with_interval(gains[peer])]


def best_table():
    """The Markdown table for all devices."""
    chapters, peers = {}, {}
    for cells, folder, pairs_of in ((chapters, "chapters", among_chapters), (peers, "peers", against_peers)):
        for record in load_records(folder):
            cells.update({(*key, record["environment"]["device"]): texts for key, texts in pairs_of(record)})
    scenes = list(dict.fromkeys(key[0] for key in [*chapters, *peers]))
    rows, before = [], None
    for key in sorted(chapters.keys() | peers.keys(), key=lambda key: (scenes.index(key[0]), *key[1:])):
        scene, width, height, device = key
        rows.append(
            [
                f"`{scene}`" if scene != before else "",
                f"{width} x {height}",
                device,
                *chapters.get(key, ["", ""]),
                *peers.get(key, ["", "", ""]),
            ]
        )
        before = scene
    head = [
        "scene",
        "pixels",
        "device",
        "best chapter",
        "times faster than the first",
        "best against Mitsuba",
        "Mitsuba at its best",
        "times faster than that",
    ]
    return table(head, rows, left=4)
