"""Runs chapters, and other renderers as their peers, and records their reports: see numbers.py.

The record is written after each run, so an interrupted measurement can continue. The runs of all cases are interleaved, so that
other load on the machine affects all of them alike.
"""
import re
import subprocess
import sys
import tempfile
import time
from datetime import datetime
from pathlib import Path

from project import (
    CHAPTERS,
    ROOT,
    UserError,
    commit,
    failure_text,
    program_file,
    read_json,
    rendered_description,
    run_program,
    show_progress,
    write_json,
)
from references.images import averaged, read_reference, read_rgb, rel_mse
from report.sources import digest, files_of

PILOT_PART = 0.3  # of a run's seconds: a pilot determines how many samples a run takes
DEVICE_LOST = 3  # exit code
LARGE = 1024  # side in pixels of a second size on GPUs, which small pictures do not fill


class Refused(UserError):
    """A program cannot render a scene, such as glass with a chapter that has no dielectrics."""


# ---------------------------------------------------------------------------------------------- cases
def relative(path):
    """A path as text, relative to the project if it is inside."""
    return str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else str(path)


def new_case(scene_file, reference_file, name, program, options=(), is_peer=False, is_large=False):
    """A case to be rendered repeatedly. Resolution and path length are the reference's, if any. A large picture has `scale` times
    that resolution, and is compared with the reference after averaging blocks of scale x scale pixels. `variables` are NAME=VALUE of
    the program's environment. The program of a peer is a command that takes a chapter's arguments."""
    case = {
        "scene": reference_file.stem if reference_file else scene_file.stem,
        "scene_file": relative(scene_file),
        "reference_file": None,
        "reference": None,
        "width": 128,
        "height": 128,
        "max_path_length": None,
        "scale": 1,
        "case": name,
        "program": program,
        "options": " ".join(options),
        "is_peer": is_peer,
        "backend": None,
        "variables": [],
        "note": "",
        "samples": None,
        "paths_per_sample": 1,
        "refused": None,
        "runs": [],
        "pictures": {},
    }
    if reference_file:
        reference = read_reference(reference_file)
        height, width, _ = reference.mean.shape
        scale = max(LARGE // max(width, height), 1) if is_large else 1
        if scale > 1:
            case["scene"] += f"_{scale * width}"
        case |= {
            "reference_file": relative(reference_file),
            "width": scale * width,
            "height": scale * height,
            "scale": scale,
            "max_path_length": int(reference.attributes["max_path_length"]),
            "reference": {
                "scene_hash": reference.attributes["scene_hash"],
                "mean": reference.mean.mean(axis=(0, 1)).tolist(),
                "variance": (reference.variance.sum(axis=(0, 1)) / (width * height) ** 2).tolist(),
                "freedom": reference.freedom,
                "rel_mse_deviation": reference.rel_mse_deviation,
            },
        }
    return case


def report_cases(scenes, chapters, is_large=False):
    """Cases of all chapters for pairs (scene file, reference file)."""
    return [
        new_case(scene, reference, f"chapter {number}", CHAPTERS[number], is_large=is_large)
        for scene, reference in scenes
        for number in chapters
    ]


# ---------------------------------------------------------------------------------------------- programs
def run_once(program, arguments, timeout):
    return run_program([*program, *arguments], timeout=timeout)


def run_case(case, settings, arguments, run=run_once):
    """The report of one run, with the seconds of the whole command, minus those of a peer's discarded renders. `run` is Batch.run
    or alike. The setting "shaders" has options --shader."""
    with tempfile.TemporaryDirectory() as folder:
        limited = ["prlimit", f"--data={settings['memory_limit'] * 2**30:.0f}"] if settings.get("memory_limit") else []
        limited += ["env", *case["variables"]] if case["variables"] else []
        program = case["program"].split() if case["is_peer"] else [*limited, program_file(case["program"])]
        command = [ROOT / case["scene_file"], "--width", case["width"], "--height", case["height"], *case["options"].split()]
        if case["reference_file"]:
            command += ["--max-path-length", case["max_path_length"]]
            command += ["--reference", ROOT / case["reference_file"]] if case["scale"] == 1 else []
        if not case["is_peer"]:
            command += ["--quiet", "--backend", case["backend"] or settings["backend"]]
            command += ["--device", settings["device"]] if settings["device"] else []
        if "--output" not in arguments:
            arguments = [*arguments, "--output", Path(folder) / "picture.exr"]
        command += [*settings.get("shaders", []), "--report", Path(folder) / "report.json", *arguments]
        started = time.perf_counter()
        limit = settings.get("time_limit")
        try:
            process = run(program, command, limit)
        except subprocess.TimeoutExpired:
            raise UserError(
                f"{case['scene']}, {case['case']}: ended after {limit:g} s: does each loop of the shader end, and each path? "
                "On a slow machine allow more by --time-limit"
            ) from None
        seconds = time.perf_counter() - started
        if process.returncode != 0:
            error = failure_text(process)
            if "cannot render" in error or case["is_peer"]:
                raise Refused(error)
            lost = "the device was lost: " if process.returncode == DEVICE_LOST else ""
            raise UserError(f"{case['scene']}, {case['case']}: {lost}{error}")
        report = read_json(Path(folder) / "report.json")
        if case["scale"] > 1:
            measure_large(case, report["rows"], arguments[arguments.index("--output") + 1])
    if case["reference"] and report["scene_hash"] != case["reference"]["scene_hash"]:
        raise UserError(
            f"{case['reference_file']}: is of another version of {case['scene_file']}: "
            f"render it again with ./lab reference {case['scene_file']}"
        )
    return report | {"command_seconds": seconds - report.get("discarded_seconds", 0)}


def measure_large(case, rows, picture):
    """Computes the error of a picture larger than its reference, for the last row only."""
    for row in rows:
        row["rel_mse"] = None
    rows[-1]["rel_mse"] = rel_mse(averaged(read_rgb(picture), case["scale"]), read_reference(ROOT / case["reference_file"]))


def driver_of(program, device):
    """Kind of the device, Vulkan's version and the driver."""
    found = re.search(
        rf"^ *\d+ +{re.escape(device)} \((.*)\)$", run_program([program_file(program), "--list-devices"]).stdout, re.MULTILINE
    )
    return found[1] if found else "unknown"


def digest_of_sources(cases):
    """A digest of all sources that affect a run: when they change, a measurement starts over."""
    references = [ROOT / case["reference_file"] for case in cases if case["reference_file"]]
    return digest(
        [*files_of(["common", "shaders", "assets"]), *ROOT.glob("chapters/*/*.glsl"), *references],
        "".join(map(rendered_description, CHAPTERS.values())),
    )


# ---------------------------------------------------------------------------------------------- measuring
class Measurement:
    """Fills a record. `pictures` is the folder for images, or None for no pictures."""

    def __init__(self, file, cases, settings, pictures=None):
        self.file, self.pictures = file, pictures
        settings = settings | {"sources": digest_of_sources(cases)}
        self.record = {"settings": settings, "environment": {}, "is_complete": False, "cases": cases}
        previous = read_json(file) if file.exists() else {"is_complete": True}
        if previous.get("settings") == settings and not previous["is_complete"]:
            self.record = previous
            done = sum(len(case["runs"]) for case in previous["cases"])
            print(f"{file}: goes on after {done} runs", file=sys.stderr)

    def save(self):
        write_json(self.file, self.record)

    def finish(self):
        self.record["is_complete"] = True

    def run_seconds(self):
        """Rendering time of one run."""
        return self.record["settings"]["seconds"] / self.record["settings"]["repetitions"]

    def steps(self):
        """All steps in order. Whether a step is still needed is decided when its turn comes."""
        cases = self.record["cases"]
        yield from ((self.try_out, case, 0) for case in cases)
        for seed in range(1, self.record["settings"]["repetitions"] + 1):
            yield from ((self.repeat, case, seed) for case in cases)
        if self.pictures:
            yield from ((self.render_equal_error, case, 1) for case in cases)

    def measure(self):
        """Performs all steps that the record lacks."""
        cases, steps = self.record["cases"], list(self.steps())
        print(
            f"{len(cases)} cases, {self.record['settings']['repetitions']} runs of {self.run_seconds():.2g} s each. "
            "Ctrl-C keeps what is there, and the same command goes on.",
            file=sys.stderr,
        )
        open_steps = [step for step in steps if self.is_open(*step)]
        started = time.monotonic()
        for done, (do, case, seed) in enumerate(open_steps, 1):
            if self.is_open(do, case, seed):
                do(case, seed)
                self.save()
            show_progress(f"{case['scene']}, {case['case']}", done, len(open_steps), started)

    def is_open(self, do, case, seed):
        if case["refused"]:
            return False
        if do == self.try_out:
            return case["samples"] is None
        return len(case["runs"]) < seed if do == self.repeat else "equal_error" not in case["pictures"]

    def try_out(self, case, _):
        """Finds the number of samples per run, the same for all runs of a case."""
        settings, limit = self.record["settings"], PILOT_PART * self.run_seconds()
        limits = ["--time-limit", limit] if case["is_peer"] else ["--time-limit", limit, "--samples", 2**32 - 1]
        try:
            report = run_case(case, settings, [*limits, "--seed", 0])
            if not report["rows"]:  # time ran out before the first sample
                report = run_case(case, settings, ["--samples", 1, "--seed", 0])
        except Refused as refusal:
            case["refused"] = str(refusal).replace(f"{ROOT}/", "")
            return
        row = report["rows"][-1]
        samples = max(1, round(row["samples"] * self.run_seconds() / row["seconds"]))
        if not case["reference_file"]:
            samples = max(2, samples)  # the error needs both halves
        case |= {"samples": samples, "backend": report["backend"], "note": report.get("note", "")}
        branches = re.search(r"--splitting-factor (\d+)", report.get("settings", ""))
        case["paths_per_sample"] = int(branches[1]) if branches else 1
        environment = self.record["environment"]
        if case["is_peer"]:
            environment["peer"] = report["device"]
        elif "device" not in environment:
            environment |= {
                "device": report["device"],
                "driver": driver_of(case["program"], report["device"]),
                "commit": commit(),
                "date": datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"),
            }

    def repeat(self, case, seed):
        case["runs"].append(self.render(case, seed, case["samples"], "equal_time" if seed == 1 else None))

    def render(self, case, seed, samples, picture):
        """Runs a case once; keeps the picture for the page if it has a name."""
        arguments = ["--samples", samples, "--seed", seed]
        if self.pictures and picture:
            file = self.pictures / f"{case['scene']}_{re.sub('[^A-Za-z0-9]+', '_', case['case'])}_{picture}.exr"
            self.pictures.mkdir(parents=True, exist_ok=True)
            arguments += ["--output", file]
        report = run_case(case, self.record["settings"], arguments)
        if self.pictures and picture:
            case["pictures"][picture] = {"file": file.name, **report["rows"][-1]}
        return {"seed": seed, "command_seconds": report["command_seconds"], "rows": report["rows"]}

    def render_equal_error(self, case, seed):
        """Renders as many samples as it takes to reach the error of the scene's noisiest case."""
        others = [other for other in self.record["cases"] if other["scene"] == case["scene"] and other["runs"]]
        errors = {id(other): sum(run["rows"][-1]["rel_mse"] for run in other["runs"]) / len(other["runs"]) for other in others}
        samples = max(1, round(case["samples"] * errors[id(case)] / (max(errors.values()) or 1)))
        self.render(case, seed, samples, "equal_error")
