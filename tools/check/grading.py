"""Grades a shader of a chapter: renders scenes that have a reference image and judges bias, noise and cost.

Means of the whole image and of its tiles are tested against the reference. Error and rays are compared with those of the
chapter's own shader, which are recorded in assets/expected.
"""
import os
import re
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from includes import named_files, shaders_of
from project import CHAPTERS, KNOWLEDGE, ROOT, UserError, description, original, printable, read_json, show_progress, text_of
from references.images import averaged, find_references, read_reference, read_rgb
from report.batch import Batch
from report.measurement import new_case, relative, run_case
from report.numbers import FALSE_ALARMS as FALSE_ALARMS_OF_REPORTS
from report.numbers import Series, biases, mean_of, paired_ratio, ratio

DESCRIPTIONS = {number: description(folder) for number, folder in CHAPTERS.items()}
# Per chapter: samples of a run, and references that show what its shader can do.
SCENES = {number: (says["check"]["samples"], says["check"]["references"]) for number, says in DESCRIPTIONS.items() if "check" in says}
# Roulette from the first bounce on and with a cap that matters, since otherwise both hardly show. With a lower cap few samples
# would dominate a picture, since survivors of eight bounces have weight 1/cap^8, and no interval would hold.
ROULETTE = ["--roulette-start", "1", "--survival-cap", "0.6", "--survival-weight", "1"]
OPTIONS = {number: ROULETTE if "--roulette-start" in says.get("options", []) else [] for number, says in DESCRIPTIONS.items()}
TILE = 16  # pixels
TILE_FLOOR = 5e-4  # of the mean of the image: see reference_regions()
FALSE_ALARMS = 0.001  # over all checks of correct shaders
TOO_MUCH = 1.5  # times the error of a sample or its rays
# The fraction of the technique's gain, on the scale of the error's logarithm, that a shader may lose; and a factor of the error
# that is never too much.
LOST_PART, LITTLE = 0.25, 1.1
RUNS, MOST_RUNS, SEED_STEP = 12, 1000, 10000
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
    2 * MOST_RUNS + 1 to SEED_STEP, with which the signatures of mistakes were measured. The chapters' levels use the seeds of --seed
    0, so that a shader which draws random numbers in the same order as the chapter's own is compared render by render."""
    return seed * SEED_STEP + 1


def expected_file(chapter):
    """What the chapter's own shader shows, or that of the chapter that this one copies: levels and experiments."""
    return ROOT / "assets/expected" / f"{CHAPTERS[original(chapter)]}.json"


def known_mistakes(chapter):
    """What each mistake of the catalogue shows in the experiments. The notebook learns it; without the notebook mistakes have no names."""
    file = KNOWLEDGE / expected_file(chapter).name
    return read_json(file) if file.exists() else {}


def functions_in(shader):
    return set(re.findall(r"^\w+ (\w+)\(", text_of(shader), re.MULTILINE))


def graded_together(chapter, file):
    """The shaders that are graded as one, the file last. Those beside a file belong to it if their folder is this chapter, a copy of it
    or a new one: it has a chapter.json, or the file has the name of one of this chapter's shaders. Any other file stands alone."""
    title = description(file.parent.resolve())["title"] if (file.parent / "chapter.json").exists() else None
    others = {says["title"] for number, says in DESCRIPTIONS.items() if expected_file(number).exists()} - {description(chapter)["title"]}
    if title in others or not (title or (ROOT / "chapters" / chapter / file.name).exists()):
        return [file]
    return [*(other for other in sorted(file.parent.glob("*.glsl")) if other.is_file() and other.name != file.name), file]


def with_most_functions_of(file, shaders):
    """Number of functions that the file has in common with one of these, and that shader: the first one of several."""
    counted = [(len(functions_in(file) & functions_in(shader)), shader) for shader in shaders]
    return max(counted, key=lambda pair: pair[0], default=(0, None))


def shader_named(chapter, file):
    """The chapter's shader with the file's name, or None. Where it extends one with the same name of another chapter: the one whose
    functions the file has."""
    return with_most_functions_of(file, [shader for shader in shaders_of(int(chapter[:2])) if shader.name == file.name])[1]


def shader_like(chapter, file):
    """The shader that a file is graded as, in a chapter's folder or included from that of another chapter. It is one of the folder whose
    functions the file all defines, preferably the estimator; or else the one with its name; a new one beside an estimator; or the one with
    most of its functions. Other estimators than the chapter's may have a function or two in common with any."""
    estimator, functions = ROOT / "chapters" / chapter / "path_trace.glsl", functions_in(file)
    folder = [estimator, *sorted(set(estimator.parent.glob("*.glsl")) - {estimator})]
    for shader in folder:
        if functions_in(shader) and functions >= functions_in(shader):
            return shader
    if named := shader_named(chapter, file):
        return named
    if estimator.name in {other.name for other in graded_together(chapter, file)}:
        return estimator.with_name(file.name)
    count, shader = with_most_functions_of(file, [*folder, *shaders_of(int(chapter[:2]))])
    if "path_trace" in functions and count < 2:
        return estimator
    if not count:
        names = ", ".join(shader.name for shader in folder)
        raise UserError(f"{printable(relative(file))}: defines no function of chapter {int(chapter[:2])}'s shaders; name it like the one that it "
                        f"replaces: {names}")
    return shader


def replacement(shader, file):
    """Options with which a program reads a file instead of a chapter's shader."""
    return ["--shader", f"{shader.parent.name}/{shader.name}={os.path.abspath(file)}"]


def replacements(chapter, file, shader=None):
    """Options with which a chapter's program reads `file`, and what belongs to it, instead of its own shaders."""
    *others, _ = graded_together(chapter, file)
    own = {shader_named(chapter, other) or ROOT / "chapters" / chapter / other.name: other for other in others}
    places = own | {shader or shader_like(chapter, file): file}
    # What the chapter neither has nor may bring is included by these files only, and found beside them.
    named = named_files(ROOT / "chapters" / chapter)
    return [word for place, source in places.items() if place.exists() or place.name in named
            for word in replacement(place, source)]


@contextmanager
def replaced(shader, text):
    """Options with which a program reads this text instead of a chapter's shader."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / shader.name
        file.write_text(text, encoding="utf-8")
        yield replacement(shader, file)


def with_names_of(file, text):
    """A text in which this file, and those beside it, have names as the user wrote them."""
    folder = f"{Path(os.path.abspath(file)).parent.as_posix()}/"
    return text.replace(printable(folder), printable(relative(file).removesuffix(file.name)))


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
    floor = (TILE_FLOOR * reference.mean.mean())**2
    channels, tiles = regions(reference.variance)[:3], regions(deviation**2)[1:]
    variance = [v / (height * width) for v in channels] + [v / TILE**2 + floor for v in tiles]
    return {"mean": regions(reference.mean), "variance": variance, "freedom": reference.freedom}


def render(chapter, file, settings, scenes=None, watch=lambda cases: None, shader=None):
    """Cases with their runs, each a row with the means of the regions. `settings`: backend, device, time_limit, memory_limit,
    runs, samples, first_seed, is_quiet, and what the progress begins with; `scenes` are names of references; `watch` is called after the
    first EARLY_RUNS and returns whether they are enough."""
    samples, own_scenes = SCENES[chapter]
    samples, started = settings["samples"] or samples, time.monotonic()
    with tempfile.TemporaryDirectory() as folder, Batch() as batch:
        settings = settings | {"shaders": replacements(CHAPTERS[chapter], file, shader)}
        cases = [new_case(*pair, f"chapter {chapter}", CHAPTERS[chapter], OPTIONS[chapter])
                 for pair in find_references(scenes or own_scenes)]
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
                report = run_case(cases[i], settings, ["--samples", samples, "--seed", settings["first_seed"] + run, "--output", picture], batch.run)
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
            raise UserError(with_names_of(file, str(error))) from None
    for case in cases:
        case["picture"] = case["picture"] / len(case["runs"])
    return cases


def level(case):
    """What the technique costs: rel_mse of a single sample, for the seed of each run, and rays per sample."""
    rows = {run["seed"]: run["rows"][-1] for run in case["runs"]}
    samples = next(iter(rows.values()))["samples"]
    return {"rel_mse": {str(seed): float(f"{row['rel_mse'] * samples:.4g}") for seed, row in rows.items()},
            "rays": float(f"{mean_of(rows.values(), 'rays') / samples / case['width'] / case['height']:.4g}")}


def most_noise(recorded):
    """How many times the recorded error of the chapter's own shader is still acceptable. If the lesson is less noise, a shader
    without it may have less than TOO_MUCH."""
    return min(TOO_MUCH, max(recorded["gain"]**LOST_PART, LITTLE)) if "gain" in recorded else TOO_MUCH


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
    rays = now["rays"] / recorded["rays"]
    # Noise compensated by fewer rays is not a fault, and neither are rays compensated by less noise.
    if case["invalid_samples"] or any(test["is_biased"] for test in [*image, *tiles]):
        verdict = "biased"
    elif noise[1] is not None and noise[1] * min(rays, 1) > most_noise(recorded):
        verdict = "noisy"
    else:
        verdict = "expensive" if rays * min(noise[1] or noise[0] or 1, 1) > TOO_MUCH else "correct"
    columns = case["width"] // TILE
    tiles = [{"row": i // columns, "column": i % columns, **test} for i, test in enumerate(tiles)]
    return {"scene": case["scene"], "verdict": verdict, "invalid_samples": case["invalid_samples"], "image": image,
            "tiles": tiles, "noise": noise, "most_noise": most_noise(recorded), "rays": rays}


def read_levels(chapter):
    """Scene -> level of the chapter's own shader."""
    if not expected_file(chapter).exists():
        raise UserError(f"chapter {chapter} has a title of its own and is not measured yet: ./lab check N FILE grades a file as chapter N's, "
                        "./lab notebook learn measures a new chapter")
    return read_json(expected_file(chapter))["levels"]


def early_bias(cases):
    """The largest difference from the reference that is certain after a few runs: the name of a scene and the relative
    difference, or None and the smallest difference that would be certain."""
    tests = [(test, case["scene"]) for case in cases
             for test in biases(case["runs"], reference_regions(ROOT / case["reference_file"]),
                                len(cases) * 3 * FALSE_ALARMS_OF_REPORTS / FALSE_ALARMS)[:3]]
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

    return [] if is_sure(results) else [result["scene"] for result in results
                                        if result["verdict"] in ("biased", "noisy") or any(map(is_near, result["image"]))]


def judge(chapter, file, settings, levels=None, scenes=None, watch=lambda cases: None, shader=None, ends_early=False):
    """The verdict on a shader and on each scene, and the mean picture of each scene; raises UserError if there is none. What is in doubt
    is rendered again, with other seeds, which decide alone: so a correct shader that was doubted is refused no more often than any other.
    With `ends_early` it takes EARLY_RUNS alone if a picture is off as a whole in them: experiments should confirm that, for all of so few
    runs may lack the same bright paths."""
    levels = levels or read_levels(chapter)

    def graded(cases, is_second_look=False):
        return [grade(case, levels[case["scene"]], len(cases), is_second_look) for case in cases]

    def is_enough(cases):
        watch(cases)
        return ends_early and is_sure(graded(cases))

    first_seed = settings["first_seed"]
    cases = render(chapter, file, settings, scenes, is_enough, shader)
    seen = {case["scene"]: (case, result) for case, result in zip(cases, graded(cases))}
    if again := doubtful([result for _, result in seen.values()]):
        cases = render(chapter, file, settings | {"first_seed": first_seed + settings["runs"]}, again, shader=shader)
        seen |= {case["scene"]: (case, result) for case, result in zip(cases, graded(cases, is_second_look=True))}
    cases, results = zip(*seen.values())
    verdict = next(word for word in VERDICTS if word in {result["verdict"] for result in results})
    return {"chapter": chapter, "file": printable(relative(file)), "verdict": verdict, "runs": min(len(case["runs"]) for case in cases),
            "samples": settings["samples"] or SCENES[chapter][0], "first_seed": first_seed, "false_alarms": FALSE_ALARMS,
            "too_much": TOO_MUCH, "picture": None, "diagnosis": None, "scenes": list(results)}, [case["picture"] for case in cases]
