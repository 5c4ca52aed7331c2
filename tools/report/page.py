"""Writes a report: the page index.html, which needs no other file, and its numbers as report.json."""
import math
from html import escape
from pathlib import Path
from string import Template

from project import ROOT, write_json
from references.images import averaged, read_reference, read_rgb
from report.numbers import CONFIDENCE, FALSE_ALARMS, POWER, TARGET_ERROR, short, summarize
from report.plots import DIFFERENCE_FACTOR, difference_picture, picture, plot_errors, style

TEMPLATE = Template(Path(__file__).with_suffix(".html").read_text(encoding="utf-8"))


def percent_of_root(error):
    return "–" if error is None else f"{100 * math.sqrt(error):.3g}&nbsp;%"


def ranged(values, digits=2):
    """[value, low, high] as HTML."""
    if values is None:
        return "–"
    value, low, high = values
    spread = "" if low is None else f' <span class="range">{short(low, digits)} – {short(high, digits)}</span>'
    return f"{short(value, digits)}{spread}"


def bias_text(result):
    """The verdict on one channel."""
    if result["half_width"] is None:
        return "one batch: unknown"
    if result["is_biased"]:
        return f'<span class="bad">biased: {100 * result["value"]:+.2g} % ± {100 * result["half_width"]:.1g} %</span>'
    return f'agrees <small>{100 * result["detectable"]:.2g} % would have been found</small>'


def table(head, rows):
    """A table in HTML; cells are HTML, too."""
    lines = ["".join(f"<{kind}>{cell}</{kind}>" for cell in row) for kind, row in [("th", head), *(("td", row) for row in rows)]]
    return '<div class="wide"><table>' + "".join(f"<tr>{line}</tr>" for line in lines) + "</table></div>"


def overview(scenes):
    """Error × time of each chapter in each scene, and where a bias was found."""
    names = list(dict.fromkeys(case["case"] for scene in scenes for case in scene["cases"]))
    rows = []
    for scene in scenes:
        found = {case["case"]: case for case in scene["cases"]}
        cells = []
        for name in names:
            case = found.get(name)
            is_biased = case and any(channel["is_biased"] for channel in case["bias"])
            cells.append(
                "–" if not case else ranged(case.get("error_time")) + (' <span class="bad">biased</span>' if is_biased else "")
            )
        rows.append([f'<a href="#{escape(scene["scene"])}">{escape(scene["scene"])}</a>', *cells])
    return "<h3>Error × time, relative to the first chapter: below 1 is better</h3>" + table(["scene", *map(escape, names)], rows)


def speed_table(scene):
    rows = [
        [
            escape(case["case"]),
            short(case["samples"]),
            ranged(case["error"], digits=3),
            percent_of_root(case["error"][0]),
            short(case.get("rays_per_sample")),
            short(case["samples_per_second"] / 1e6),
            short(case["paths_per_second"] / 1e6),
            short(case["rays_per_second"] / 1e6) if case["rays"] else "–",
            short(case["rays_per_device_second"] / 1e6) if case["rays"] else "–",
            short(case["seconds"]),
            short(case["device_seconds"]),
            ranged(case["slope_samples"]),
            ranged(case["slope_seconds"]),
            ranged(case.get("error_time")),
            ranged(case.get("error_device_time")),
        ]
        for case in scene["cases"]
    ]
    head = [
        "",
        "samples",
        "error",
        "its root",
        "rays per sample",
        "Msamples/s",
        "Mpaths/s",
        "Mrays/s",
        "Mrays/s of device time",
        "wall s",
        "device s",
        "slope against samples",
        "against seconds",
        "error × time",
        "error × device time",
    ]
    return table(head, rows)


def bias_table(scene):
    rows = [[escape(case["case"]), *map(bias_text, case["bias"])] for case in scene["cases"]]
    return "<h3>Bias</h3>" + table(["", "red", "green", "blue"], rows)


def peer_tables(scene):
    """Time to equal error compared with Mitsuba, for rendering alone and for the whole command."""
    ours = [case for case in scene["cases"] if not case["is_peer"]]
    peers = [case["case"] for case in scene["cases"] if case["is_peer"]]
    if not ours or not peers:
        return ""
    gains = {(gain["case"], gain["peer"]): gain["gain"] for gain in scene["gains"]}
    rows = [[escape(case["case"]), *(ranged(gains[case["case"], peer]) for peer in peers)] for case in ours]
    best = max(ours, key=lambda case: gains[case["case"], peers[0]][0] or 0)
    starts = [
        [escape(case["case"]), ranged(case["seconds_to_target"]), ranged(case["start_up_seconds"])] for case in scene["cases"]
    ]
    notes = "".join(f"<p>{escape(case['case'])}: {escape(case['note'])}.</p>" for case in scene["cases"] if case["note"])
    notes += "<p>What differs between the programs: see docs/results.md.</p>"
    return (
        "<h3>Time to equal error: how many times faster than Mitsuba</h3>"
        f"<p>Wall time of rendering alone; the fastest is {escape(best['case'])}.</p>"
        + table(["", *map(escape, peers)], rows)
        + notes
        + f"<h3>Seconds from the command to {100 * TARGET_ERROR:.0f} % error</h3><p>With start-up: the process, the scene, its kernels "
        "(which both keep from earlier runs). The error is taken to fall as 1 / samples beyond what was rendered.</p>"
        + table(["", "seconds", "of which start-up"], starts)
    )


def picture_rows(record, name, folder):
    """Pictures and differences of a scene at equal time and equal error."""
    cases = [case for case in record["cases"] if case["scene"] == name]
    reference_file = cases[0]["reference_file"]
    reference = read_reference(ROOT / reference_file).mean
    parts = []
    for kind, title in (("equal_time", "Equal time"), ("equal_error", "Equal error")):
        figures = [f'<figure><img src="{picture(reference)}" alt="reference">reference</figure>']
        for case in cases:
            if kind not in case["pictures"]:
                continue
            row = case["pictures"][kind]
            radiance = averaged(read_rgb(folder / row["file"]), case["scale"])
            caption = f"{row['samples']} samples, {short(row['seconds'])} s, error {percent_of_root(row['rel_mse'])}"
            figures.append(
                f'<figure><img src="{picture(radiance)}" alt="{escape(case["case"])}">'
                f'<img src="{difference_picture(radiance, reference)}" alt="difference">'
                f"<b>{escape(case['case'])}</b><br>{caption}</figure>"
            )
        if len(figures) > 1:
            parts.append(f'<h3>{title}</h3><div class="pictures">{"".join(figures)}</div>')
    if parts:
        parts.append(
            f"<p><small>Lower pictures: difference of luminance from the reference × {DIFFERENCE_FACTOR}, relative to the reference's "
            "mean; red is too bright, blue too dark. Where one sample has less error than the noisiest chapter, one was taken.</small></p>"
        )
    return "".join(parts)


def scene_section(record, scene, folder):
    name, styles, peers = scene["scene"], {}, 0
    for case in scene["cases"]:
        number = int(case["program"][:2]) - 1 if not case["is_peer"] else 0
        styles[case["case"]] = style(case, number, peers)
        peers += case["is_peer"]
    refused = "".join(f"<li>{escape(item['case'])} does not render it: {escape(item['why'])}</li>" for item in scene["refused"])
    text = (
        f'<h2 id="{escape(name)}">{escape(name)}</h2><p>{scene["width"]} × {scene["height"]} pixels, paths of up to '
        f'{scene["max_path_length"]} bounces.</p>' + (f"<ul>{refused}</ul>" if refused else "")
    )
    if scene["cases"]:
        text += plot_errors(scene, styles) + speed_table(scene) + bias_table(scene) + peer_tables(scene)
    return text + picture_rows(record, name, folder)


def progress_note(record):
    wanted = sum(record["settings"]["repetitions"] for case in record["cases"] if not case["refused"])
    done = sum(len(case["runs"]) for case in record["cases"])
    return "" if done == wanted else f'<p class="note">Interrupted after {done} of {wanted} runs; the same command goes on.</p>'


def page(record, scenes, folder):
    settings, environment = record["settings"], record["environment"]
    backends = sorted({case["backend"] for case in record["cases"] if case["backend"] and not case["is_peer"]})
    facts = {
        "device": environment.get("device"),
        "driver": environment.get("driver"),
        "backend": ", ".join(backends),
        "compared with": environment.get("peer"),
        "commit": environment.get("commit"),
        "date": environment.get("date"),
        "settings": f"{settings['repetitions']} interleaved runs of about {settings['seconds'] / settings['repetitions']:.2g} s for each "
        f"chapter and scene, seeds 1 to {settings['repetitions']}",
    }
    lines = table(["", ""], [[f"<b>{key}</b>", f"{escape(str(value))}"] for key, value in facts.items() if value]).replace(
        "<td>", '<td class="text">'
    )
    body = "".join(scene_section(record, scene, folder) for scene in scenes)
    percents = {"confidence": CONFIDENCE, "false_alarms": FALSE_ALARMS, "power": POWER}
    return TEMPLATE.substitute(
        facts=progress_note(record) + lines,
        scenes=overview(scenes) + body,
        **{name: f"{100 * value:.0f}" for name, value in percents.items()},
    )


def write_report(record, folder):
    """All files; pictures are in folder/pictures."""
    scenes = summarize(record)
    content = {key: record[key] for key in ("settings", "environment", "measured") if key in record} | {"scenes": scenes}
    write_json(folder / "report.json", content)
    (folder / "index.html").write_text(page(record, scenes, folder / "pictures"), encoding="utf-8")
