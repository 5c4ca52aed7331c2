"""Grades a shader of a chapter: renders scenes that have a reference image and judges bias, noise and cost.

Means of the whole image and of its tiles are tested against the reference. Error and rays are compared with those of the
chapter's own shader, which are recorded in assets/expected.
"""
import os
import tempfile
import threading
import time
from pathlib import Path

import numpy as np
from check.expected import DESCRIPTIONS, expected_file
from project import CHAPTERS, ROOT, UserError, description, read_json, show_progress
from references.images import averaged, find_references, read_reference, read_rgb
from report.batch import Batch
from report.measurement import new_case, run_case
from report.numbers import FALSE_ALARMS as FALSE_ALARMS_OF_REPORTS
from report.numbers import Series, biases, mean_of, paired_ratio, ratio

# Per chapter: samples of a run, and references that show what its shader can do.
SCENES = {
    number: (says["check"]["samples"], says["check"]["references"]) for number, says in DESCRIPTIONS.items() if "check" in says
}
# Roulette from the first bounce on and with a cap that matters, since otherwise both hardly show. With a lower cap few samples
# would dominate a picture, since survivors of eight bounces have weight 1/cap^8, and no interval would hold.
ROULETTE = ["--roulette-start", "1", "--survival-cap", "0.6", "--survival-weight", "1"]
# Each thread renders all samples of its pixel where a chapter has a loop of its own over them. Otherwise one sample a thread is all
# that a small picture needs, and no path follows another.
ONE_THREAD = ["--max-threads-per-pixel", "1"]


def has_sample_loop(folder):
    """Whether a chapter, or one that it continues, has a loop of its own over the samples."""
    earlier = description(folder).get("continues")
    return (ROOT / "chapters" / folder / "sample_loop.glsl").exists() or (earlier is not None and has_sample_loop(earlier))


OPTIONS = {
    number: [
        *(ROULETTE if "--roulette-start" in says.get("options", []) else []),
        *(ONE_THREAD if has_sample_loop(CHAPTERS[number]) else []),
    ]
    for number, says in DESCRIPTIONS.items()
}
TILE = 16  # pixels
TILE_FLOOR = 5e-4  # of the mean of the image: see reference_regions()
FALSE_ALARMS = 0.001  # over all checks of correct shaders
TOO_MUCH = 1.5  # times the error of a sample or its rays
# The fraction of the technique's gain, on the scale of the error's logarithm, that a shader may lose; and a factor of the error
# that is never too much.
LOST_PART, LITTLE = 0.25, 1.1
RUNS, MOST_RUNS, SEED_STEP = 12, 1000, 10000
CLOSER_RUNS, CLOSER_SAMPLES = 16, 4  # of a closer look: runs, and times the samples of a run
NEAR = 1.5  # times the half width of its interval: a mean farther from the reference is rendered again, by chance one of 150
EARLY_RUNS = 4  # after these a first verdict is worth reporting
PATIENCE = 10  # a check of RUNS runs may take this many times the limit of a single render
VERDICTS = ("biased", "noisy", "expensive", "correct")  # the first one that any scene has wins


def stay_in_the_driver(backend):
    """Keeps what is graded from the C++ compiler unless `native` is requested: compiling takes it longer than a check's pictures."""
    if backend != "native":
        os.environ["LAB_WITHOUT_NATIVE"] = "1"


def first_seed(seed):
    """The seed of the first run of a check with this --seed. Checks with different ones share no render. None uses the seeds from
    2 * MOST_RUNS + CLOSER_RUNS + 1 to SEED_STEP, with which the signatures of mistakes were measured. The chapters' levels use the
    seeds of --seed 0, so that a shader which draws random numbers in the same order as the chapter's own is compared render by render.
    """
    return seed * SEED_STEP + 1


def regions(image):
    """Means of red, green and blue over the whole image [3], and of all channels over its tiles [rows * columns]."""
    tiles = averaged(image.mean(axis=2, keepdims=True), TILE)
    return [*image.mean(axis=(0, 1)).tolist(), *tiles.ravel().tolist()]


def reference_regions(file):
    """The regions of a reference, in the form that biases() needs. Pixels and channels of the reference have their own errors;
    those of channels may be correlated, at worst completely."""
    reference = read_reference(file)
    height, width, _ = reference.mean.shape
    deviation = np.sqrt(reference.variance).mean(axis=2, keepdims=True)
    # A tile that a few paths of all the runs reach has no spread where they miss it: differences there that are a small fraction
    # of the image's mean count as noise.
    floor = (TILE_FLOOR * reference.mean.mean()) ** 2
    channels, tiles = regions(reference.variance)[:3], regions(deviation**2)[1:]
    variance = [v / (height * width) for v in channels] + [v / TILE**2 + floor for v in tiles]
    return {"mean": regions(reference.mean), "variance": variance, "freedom": reference.freedom}


def render(submission, settings, scenes=None, watch=lambda cases: None):
    """Cases with their runs, each a row with the means of the regions. `settings`: backend, device, time_limit, memory_limit,
    runs, samples, first_seed, is_quiet, and what the progress begins with; `scenes` are names of references; `watch` is called after the
    first EARLY_RUNS and returns whether they are enough."""
    chapter, (samples, own_scenes) = submission.chapter, SCENES[submission.chapter]
    samples, started = settings["samples"] or samples, time.monotonic()
    with tempfile.TemporaryDirectory() as folder, Batch() as batch:
        settings = settings | {"shaders": submission.options}
        cases = [
            new_case(*pair, f"chapter {chapter}", CHAPTERS[chapter], OPTIONS[chapter])
            for pair in find_references(scenes or own_scenes)
        ]
        for case in cases:
            case |= {"invalid_samples": 0, "picture": 0}
        # The last scene first: the first two are often the same, and renders that start together would compile its shader twice.
        work = [(run, i) for run in range(settings["runs"]) for i in reversed(range(len(cases)))]

        limit, has_failed = PATIENCE * settings["time_limit"] * max(settings["runs"] / RUNS, 1), threading.Event()

        def render_one(item):
            run, i = item
            if has_failed.is_set():  # another one did: waiting ones need not start
                raise UserError("ended")
            try:
                if time.monotonic() - started > limit:
                    raise UserError(f"ended after {limit:g} s in all: on a slow machine allow more by --time-limit")
                picture = Path(folder) / f"{run}_{i}.exr"
                report = run_case(
                    cases[i],
                    settings,
                    ["--samples", samples, "--seed", settings["first_seed"] + run, "--output", picture],
                    batch.run,
                )
                return report, read_rgb(picture)
            except BaseException:
                has_failed.set()
                raise

        try:
            for done, ((run, i), (report, image)) in enumerate(zip(work, batch.map(render_one, work)), 1):
                case, row = cases[i], report["rows"][-1]
                row["mean"] = regions(image)
                case["runs"].append({"seed": settings["first_seed"] + run, "rows": [row]})
                case["invalid_samples"] += report["invalid_samples"]
                case["picture"] = case["picture"] + image
                if not settings["is_quiet"]:
                    show_progress(settings["what"] + case["scene"], done, len(work), started)
                if done == EARLY_RUNS * len(cases) < len(work) and watch(cases):
                    break
        except UserError as error:
            raise UserError(submission.in_words(str(error))) from None
    for case in cases:
        case["picture"] = case["picture"] / len(case["runs"])
    return cases


def level(case):
    """What the technique costs: rel_mse of a single sample, for the seed of each run, and rays per sample."""
    rows = {run["seed"]: run["rows"][-1] for run in case["runs"]}
    samples = next(iter(rows.values()))["samples"]
    return {
        "rel_mse": {str(seed): float(f"{row['rel_mse'] * samples:.4g}") for seed, row in rows.items()},
        "rays": float(f"{mean_of(rows.values(), 'rays') / samples / case['width'] / case['height']:.4g}"),
    }


def most_noise(recorded):
    """How many times the recorded error of the chapter's own shader is still acceptable. If the lesson is less noise, a shader
    without it may have less than TOO_MUCH."""
    return min(TOO_MUCH, max(recorded["gain"] ** LOST_PART, LITTLE)) if "gain" in recorded else TOO_MUCH


def grade(case, recorded, scenes, is_second_look=False):
    """The verdict on one of so many scenes, with the numbers it is based on. In a second look, the three means of a picture get as large
    a share of the false alarms as all of its tiles, so that a small bias shows."""
    reference, now = reference_regions(ROOT / case["reference_file"]), level(case)

    def tests(count):
        return biases(case["runs"], reference, scenes * count * FALSE_ALARMS_OF_REPORTS / FALSE_ALARMS)

    every = len(reference["mean"])
    image, tiles = (tests(2 * 3)[:3], tests(2 * every)[3:]) if is_second_look else (tests(every)[:3], tests(every)[3:])
    errors = [Series(level["rel_mse"]) for level in (now, recorded)]
    is_paired = len(now["rel_mse"]) > 1 and now["rel_mse"].keys() <= recorded["rel_mse"].keys()
    noise = paired_ratio(*errors) if is_paired else ratio(*errors)
    columns = case["width"] // TILE
    tiles = [{"row": i // columns, "column": i % columns, **test} for i, test in enumerate(tiles)]
    result = {
        "scene": case["scene"],
        "verdict": "biased",
        "invalid_samples": case["invalid_samples"],
        "image": image,
        "tiles": tiles,
        "noise": noise,
        "most_noise": most_noise(recorded),
        "rays": now["rays"] / recorded["rays"],
    }
    is_biased = case["invalid_samples"] or any(test["is_biased"] for test in [*image, *tiles])
    return result if is_biased else result | {"verdict": verdict_without_bias(result)}


def verdict_without_bias(scene):
    """Noise compensated by fewer rays is not a fault, and neither are rays compensated by less noise."""
    noise, rays = scene["noise"], scene["rays"]
    if noise[1] is not None and noise[1] * min(rays, 1) > scene["most_noise"]:
        return "noisy"
    return "expensive" if rays * min(noise[1] or noise[0] or 1, 1) > TOO_MUCH else "correct"


def read_levels(chapter):
    """Scene -> level of the chapter's own shader."""
    if not expected_file(chapter).exists():
        raise UserError(
            f"chapter {chapter} has a title of its own and is not measured yet: ./lab check N FILE grades a file as chapter N's, "
            "./lab notebook learn measures a new chapter"
        )
    return read_json(expected_file(chapter))["levels"]


def early_bias(cases):
    """The largest difference from the reference that is certain after a few runs: the name of a scene and the relative
    difference, or None and the smallest difference that would be certain."""
    tests = [
        (test, case["scene"])
        for case in cases
        for test in biases(
            case["runs"],
            reference_regions(ROOT / case["reference_file"]),
            len(cases) * 3 * FALSE_ALARMS_OF_REPORTS / FALSE_ALARMS,
        )[:3]
    ]
    sure = [(test["value"], scene) for test, scene in tests if test["is_biased"]]
    if sure:
        value, scene = max(sure, key=lambda pair: abs(pair[0]))
        return scene, value
    return None, max(test["detectable"] for test, _ in tests)


def is_sure(results):
    """Whether a picture is off as a whole."""
    return any(result["invalid_samples"] or any(test["is_biased"] for test in result["image"]) for result in results)


def doubtful(results):
    """The scenes in which one bright path, or its absence, may have decided, if no picture is off as a whole: tiles are off, there is noise,
    or the mean is far outside of its interval, but not far enough to be sure."""

    def is_near(test):
        return test["half_width"] is not None and abs(test["value"]) > NEAR * test["half_width"]

    return (
        []
        if is_sure(results)
        else [
            result["scene"]
            for result in results
            if result["verdict"] in ("biased", "noisy") or any(map(is_near, result["image"]))
        ]
    )


def first_verdict(results):
    return next(word for word in VERDICTS if word in {result["verdict"] for result in results})


def judge(submission, settings, levels=None, watch=lambda cases: None, is_enough=lambda results: False):
    """The verdict on a shader and on each scene, and the mean picture of each scene; raises UserError if there is none. What is in doubt
    is rendered again, with other seeds, which decide alone: so a correct shader that was doubted is refused no more often than any other.
    It takes EARLY_RUNS alone if what they show of the scenes is enough."""
    levels = levels or read_levels(submission.chapter)

    def graded(cases, is_second_look=False):
        return [grade(case, levels[case["scene"]], len(cases), is_second_look) for case in cases]

    def watch_and_end(cases):
        watch(cases)
        return is_enough(graded(cases))

    first_seed = settings["first_seed"]
    cases = render(submission, settings, watch=watch_and_end)
    seen = {case["scene"]: (case, result) for case, result in zip(cases, graded(cases))}
    is_early = len(cases[0]["runs"]) < settings["runs"]
    if again := [] if is_early else doubtful([result for _, result in seen.values()]):
        cases = render(submission, settings | {"first_seed": first_seed + settings["runs"]}, again)
        seen |= {case["scene"]: (case, result) for case, result in zip(cases, graded(cases, is_second_look=True))}
    cases, results = zip(*seen.values())
    return {
        "chapter": submission.chapter,
        "file": submission.name,
        "verdict": first_verdict(results),
        "runs": min(len(case["runs"]) for case in cases),
        "samples": settings["samples"] or SCENES[submission.chapter][0],
        "first_seed": first_seed,
        "false_alarms": FALSE_ALARMS,
        "too_much": TOO_MUCH,
        "picture": None,
        "diagnosis": None,
        "scenes": list(results),
    }, [case["picture"] for case in cases]


def look_closer(submission, settings, result, pictures):
    """Judges the biased scenes anew, by many more samples, which decide alone: where few paths bring most of the light, all renders may
    lack the same ones. For shaders that no experiment calls biased. Changes what judge() has returned. A scene that is not biased keeps
    the noise that it had, since that of points may depend on the number of samples, unless it has even more."""
    levels = read_levels(submission.chapter)
    places = {scene["scene"]: i for i, scene in enumerate(result["scenes"]) if scene["verdict"] == "biased"}
    closer = {
        "runs": CLOSER_RUNS,
        "samples": CLOSER_SAMPLES * result["samples"],
        "first_seed": settings["first_seed"] + 2 * MOST_RUNS,
    }
    for case in render(submission, settings | closer, list(places)):
        place, now = places[case["scene"]], grade(case, levels[case["scene"]], len(places), is_second_look=True)
        noisier = max(now, result["scenes"][place], key=lambda scene: scene["noise"][1] or 0)
        now |= {key: noisier[key] for key in ("noise", "rays")}
        if now["verdict"] != "biased":
            now["verdict"] = verdict_without_bias(now)
        result["scenes"][place], pictures[place] = now, case["picture"]
    result["verdict"] = first_verdict(result["scenes"])
