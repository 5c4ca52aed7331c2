"""Compares our best chapter with other renderers at equal error, on the CPU, for few and for many samples. Where the file has runs
already, those that are missing are added.

    for name in mitsuba cycles luxcore; do ./lab notebook install_peer $name; done
    . output/peers/mitsuba/bin/activate
    ./lab notebook renderers --record notebook/records/renderers/DEVICE.json
"""
import shutil
import time
from pathlib import Path

from peers.machine import processor
from peers.renderers import python_of, renderer_of
from project import Parser, UserError, chapter_named, number, read_json, scene_of, show_progress, write_json
from references.images import find_references
from report.measurement import Refused, digest_of_sources, new_case, run_case
from tables.sources import stamped

GOES_ON = True
COUNTS = [16, 64, 256, 1024]  # samples of a pixel
# Scene: (numbers of samples, the chapter that is the best there, its options). A sample of fog takes others the longest.
SCENES = {
    "cornell_box": (COUNTS, "path_regeneration"),
    "heart_light": (COUNTS, "many_lights"),
    "clear_glass": (COUNTS, "path_regeneration", "--survival-cap", "1"),
    "fog": (COUNTS[:-1], "media", "--distance-sampling", "equiangular"),
    "microfacets": (COUNTS, "microfacets", "--survival-cap", "1", "--survival-weight", "0.25"),
    "lamps": (COUNTS, "many_lights"),
}
PEERS = {  # case: (--variant, --sampler)
    "Mitsuba LLVM": ("llvm_ad_rgb", "independent"),
    "Mitsuba LLVM, multijitter": ("llvm_ad_rgb", "multijitter"),
    "Cycles, light tree": ("cycles", "light_tree"),
    "Cycles, no light tree": ("cycles", "no_light_tree"),
    "LuxCore, Sobol": ("luxcore", "sobol"),
    "LuxCore, random": ("luxcore", "random"),
}


def our_case(scene, reference):
    _, chapter, *options = SCENES[scene.stem]
    folder = chapter_named(chapter)
    name = " ".join([f"chapter {int(folder[:2])}, native", *options])
    return new_case(scene, reference, name, folder, options) | {"backend": "native"}


def peer_case(scene, reference, name):
    variant, sampler = PEERS[name]
    program = f"{python_of(renderer_of(variant))} notebook peer --variant {variant}"
    return new_case(scene, reference, name, program, ("--sampler", sampler), is_peer=True)


def all_cases():
    return [
        case
        for scene, reference in find_references(SCENES)
        for case in (our_case(scene, reference), *(peer_case(scene, reference, name) for name in PEERS))
    ]


def render(case, seed):
    """The run with this seed. A chapter's rows are those of one picture, whose first samples are those of a smaller one."""
    settings = {"backend": case["backend"], "device": None}
    counts, *_ = SCENES[scene_of(case["scene"])]
    report = run_case(case, settings, ["--samples", *(counts if case["is_peer"] else counts[-1:]), "--seed", seed])
    rows = report["rows"] if case["is_peer"] else [row for row in report["rows"] if row["samples"] in counts]
    return {"seed": seed, "rows": rows}, report["device"]


def refuse_without_peers():
    for renderer in dict.fromkeys(map(renderer_of, (variant for variant, _ in PEERS.values()))):
        if not shutil.which(python_of(renderer)):
            raise UserError(f"{renderer} is not installed: ./lab notebook install_peer {renderer}")


def opened(file):
    """The record in the file if it measured the same, or an empty one."""
    cases = all_cases()
    environment = dict(zip(("processor", "cores"), processor())) | {"renderers": {}}
    record = {"settings": {"sources": digest_of_sources(cases)}, "environment": environment, "cases": cases}
    previous = read_json(file) if file.exists() else {}
    if previous.get("settings") != record["settings"]:
        return record
    runs = {(case["scene"], case["case"]): case for case in previous["cases"]}
    return previous | {"cases": [runs.get((case["scene"], case["case"]), case) for case in cases]}


def main():
    parser = Parser("./lab notebook renderers", __doc__)
    parser.add_argument("--record", type=Path, required=True, metavar="FILE.json")
    parser.add_argument("--repetitions", type=number(int, 2, 100), default=4, help="runs with other random numbers; default: 4")
    options = parser.parse_args()
    refuse_without_peers()
    record, started = opened(options.record), time.monotonic()
    steps = [(seed, case) for seed in range(1, options.repetitions + 1) for case in record["cases"] if len(case["runs"]) < seed]
    for done, (seed, case) in enumerate(steps, 1):
        if not case["refused"]:
            try:
                run, device = render(case, seed)
                case["runs"].append(run)
                record["environment"]["renderers"][case["case"]] = device
            except Refused as refusal:
                if "is not compared" not in str(refusal):
                    raise UserError(f"{case['scene']}, {case['case']}: {refusal}") from None
                case["refused"] = str(refusal)
            record = stamped(record)
            write_json(options.record, record)
        show_progress(f"{case['scene']}, {case['case']}", done, len(steps), started)
    print(f"{options.record}: complete; ./lab notebook export shows what is in notebook/records")
