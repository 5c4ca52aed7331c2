"""The lab in the browser: what the pages of a book need to render its chapters.

A line <!-- live: SCENE --> on a chapter's page becomes a frame in which the chapter renders this scene or those of its check. On
other pages the marker names the chapter, too, and there may be several scenes: <!-- live: SCENE, SCENE by uniform_sampling -->; there a
button under each whole estimator puts it into the frame. The frames of a chapter offer the scenes of all pages.
<!-- live: PICTURE by CHAPTER bug NUMBER --> starts from a mistake of ./lab bug, in one of the chapter's pictures. <!-- live: report -->
becomes a button that tries a few chapters and tells how a device did. The program dump_arrays writes a scene's arrays; the shaders and
live/*.js are the same for all pages.
"""
import base64
import gzip
import hashlib
import json
import re
import struct
import tempfile
from array import array
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise
from pathlib import Path

from book.code_blocks import exercise_parts
from check import facts
from check.diagnosis import FIRST_SEED
from check.experiments import SIZE, experiments_of, known_sights, write_scene
from check.grading import expected_file
from project import (
    CHAPTERS,
    ROOT,
    UserError,
    chapter_named,
    description,
    failure_text,
    original,
    program_file,
    read_json,
    run_program,
    scene_of,
)

HERE = Path(__file__).parent / "live"
SCRIPTS = [
    "preprocessor.js",
    "layout.js",
    "translation.js",
    "glsl.js",
    "verdict.js",
    "facts.js",
    "loading.js",
    "film.js",
    "splats.js",
    "renderer.js",
    "denoiser.js",
    "editor.js",
    "solver.js",
    "plot.js",
    "camera.js",
    "path.js",
    "path_panel.js",
    "picture.js",
    "controls.js",
    "check.js",
    "report.js",
    "page.js",
]
RULES = ["SURE", "TOLERANCE", "CLOSE", "INTERVAL", "DARK", "FEW_PARTS", "CONSTANTS"]  # of facts.py, which facts.js follows
MARKER = re.compile(r"^<!-- live: (\w+(?:, \w+)*)(?: by (\w+)(?: bug (\d+))?)? -->$", re.MULTILINE)
REPORT = "report"
LARGEST = 2_500_000  # bytes of a scene on a page
LENGTH = 6  # of paths where a scene has no reference
SIZE_OF_PICTURE = ["--width", "256", "--height", "256"]  # there, too
HALF_LARGEST = 30_000  # what the largest number of an image is scaled to: halves end at 65504 and lose digits below 6e-5
SHADERS = {".glsl", ".h", ".frag"}
REPLACEABLE = "shaders/replaceable.json"  # the files that a chapter may replace
CONTINUED = "chapters/continued.json"  # {chapter: that which it continues}: written for pages
IN_DRAWS = {
    "engine/sample_loop.glsl": "engine/single_sample.glsl",
    "engine/splats.glsl": "engine/splats_of_a_draw.glsl",
    "engine/stuck_loop.glsl": "engine/stuck_loop_of_a_draw.glsl",
    "observation/recorded_events.glsl": "observation/recorded_event_of_a_draw.glsl",
}  # what a page has in place of the programs'
OBSERVERS = {
    "view.glsl",
    "record_path.frag",
    "record_path/path_trace.glsl",
    "record_path/sample_loop.glsl",
    "recorded_path.h",
    "recorded_event_of_a_draw.glsl",
}


def frames_of(text, path):
    """{chapter: scenes} of a page's markers."""
    return {
        chapter_of(marker, path): marker[1].split(", ")
        for marker in MARKER.finditer(text)
        if marker[1] != REPORT and not marker[3]
    }


def chapter_of(marker, path):
    """The chapter that a marker names, or else the one whose page it is on."""
    return chapter_named(marker[2]) if marker[2] else path.parent.name


def with_frames(text, path):
    """The text of a page with frames, as HTML, in place of its markers."""
    folder = "../" * (len(path.parts) - 1) + "live/"

    def frame(marker):
        what = REPORT if marker[1] == REPORT else chapter_of(marker, path)
        more = ""
        if marker[3]:
            more = f' data-bug="{marker[3]}" data-picture="{marker[1]}"'
        elif marker[2]:
            more = " data-steps"  # the page's blocks of code can be put into the frame
        return (
            f'<div class="live" data-chapter="{what}" data-folder="{folder}"{more}>'
            f"<noscript>Here the chapter renders in your browser, if it may run scripts.</noscript></div>\n"
        )

    text, count = MARKER.subn(frame, text)
    scripts = "".join(f'<script src="{folder}{name}"></script>' for name in ["sources.js", *SCRIPTS])
    return text + (f'\n\n<link rel="stylesheet" href="{folder}live.css">{scripts}\n' if count else "")


def shaders():
    """The texts of all shaders that a browser may include: of the engine, the world and the chapters. Pages trace rays as
    `compute` does. Of those that observe paths, they have the view of
    surfaces and the recorder. Comments are left out where no page shows the file."""
    files = [ROOT / REPLACEABLE] + [
        file
        for room in ("shaders", "chapters")
        for file in sorted((ROOT / room).rglob("*"))
        if file.suffix in SHADERS and (file.parent.name != "trace_ray" or file.stem in ("compute", "bvh"))
    ]
    texts = {
        file.relative_to(ROOT).as_posix(): file.read_text(encoding="utf-8")
        for file in files
        if any(map(file.match, OBSERVERS)) or not {"solutions", "variants", "observation"} & set(file.parts)
    }
    for name, replacement in IN_DRAWS.items():
        texts[f"shaders/{name}"] = texts.pop(f"shaders/{replacement}")
    texts[CONTINUED] = literal({chapter: description(chapter).get("continues") for chapter in CHAPTERS.values()})
    return {name: text if name.startswith("chapters/") else re.sub("[ \t]*//.*", "", text) for name, text in texts.items()}


def without_comments(text):
    """A script without indentation and lines of comments, which a page need not load. Lines keep their numbers."""
    return re.sub(r"^ *//.*|^ +", "", text, flags=re.MULTILINE)


def pictures_of(chapter, scenes):
    """The names of the pictures that a chapter's frame offers: references of the pages' scenes, the longest paths first, then its
    check's. Another scene than the first need not have a reference."""

    def pictures(scene):
        files = (ROOT / "assets/references").glob(f"{scene}_*.exr")
        return sorted((file.stem for file in files if scene_of(file.stem) == scene), key=lambda name: -length_of(name))

    first, *others = scenes
    if not pictures(first):
        raise UserError(f"chapters/{chapter}/README.md: live: {first}: this scene has no reference")
    names = pictures(first) + [name for scene in others for name in pictures(scene) or [f"{scene}_{LENGTH}"]]
    return list(dict.fromkeys(names + description(chapter)["check"]["references"]))


def length_of(reference):
    return int(reference.rpartition("_")[2])


@cache
def packed(data):  # chapters share scenes
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


def halves(numbers):
    """Numbers of at least 0 as 16-bit floats, and the factor that they have been divided by."""
    scale = max(max(numbers), 1e-30) / HALF_LARGEST
    return struct.pack(f"<{len(numbers)}e", *(number / scale for number in numbers)), scale


def dump(file, chapter, *scene_and_options):
    """What dump_arrays writes for a chapter: a scene's arrays as a page loads them, the parameters, the estimator's defines, and the
    pictures of the reference, if there is one, as (description, numbers)."""
    if not program_file("dump_arrays").is_file():
        raise UserError("dump_arrays is not built: ./lab book builds it")
    estimator = CHAPTERS[original(int(chapter[:2]))]  # the program may be that of a tree without the copy
    process = run_program([program_file("dump_arrays"), file, estimator, *scene_and_options])
    if process.returncode != 0:
        raise UserError(f"{chapter}: {failure_text(process)}")
    arrays, content = read_json(file.with_suffix(".json")), file.with_suffix(".bin").read_bytes()

    def numbers(entry, code):
        return array(code, content[4 * entry["first"] : 4 * (entry["first"] + entry["count"])])

    (parameters,), options = arrays.pop("parameters"), arrays.pop("options")
    reference = [(entry, numbers(entry, "f")) for entry in arrays.pop("reference", [])]
    return arrays | {"packed": packed(content[: 4 * parameters["first"]])}, list(numbers(parameters, "I")), options, reference


def dumped(chapter, name, folder):
    """A picture's entry, and the scripts that it loads: {file name: text}."""
    arrays, parameters, _, reference = dump(
        folder / f"{chapter}_{name}", chapter, scene_of(name), "--max-path-length", length_of(name), *SIZE_OF_PICTURE
    )
    scene = f"{scene_of(name)}_{hashlib.sha256(json.dumps(arrays).encode()).hexdigest()[:8]}"
    entry, scripts = {"name": name, "scene": scene, "parameters": parameters}, {scene: script(scene, arrays)}
    if reference:
        entry["reference"] = f"reference_{name}"
        scripts[entry["reference"]] = script(entry["reference"], packed_reference(*reference))
    return entry, scripts


def packed_reference(means, variances):
    """A reference as a page loads it, from its two pictures."""
    (told, mean), (_, variance) = means, variances
    (means, mean_scale), (deviations, deviation_scale) = halves(mean), halves([number**0.5 for number in variance])
    numbers = means + deviations
    return {
        "width": told["width"],
        "height": told["height"],
        "samples": float(told["samples"]),
        "scales": [mean_scale, deviation_scale],
        "packed": packed(numbers[::2] + numbers[1::2]),  # low and high bytes apart are smaller
    }


def fits(scripts):
    """Whether a page may load these scripts."""
    return sum(map(len, scripts.values())) <= LARGEST


def literal(value):
    return json.dumps(value, separators=(",", ":"))


def script(name, value):
    return f"live.data[{json.dumps(name)}] = {literal(value)};\n"


def experiments_of_page(chapter, folder):
    """The experiments of ./lab check as a page renders them: their scenes' arrays, each once, and what the chapter's own shader shows.
    A new chapter has none until ./lab notebook learn has measured it."""
    number = int(chapter[:2])
    measured, shown, scenes = expected_file(number), [], []
    expected = read_json(measured)["experiments"] if measured.exists() else {}
    for name, experiment in experiments_of(number).items():
        if name not in expected:
            continue
        points, sights = [], known_sights(expected[name])
        for index, (point, sight) in enumerate(zip(experiment.points, sights)):
            file = write_scene(point.scene, folder, f"{chapter}_{name}_{index}")
            arrays, parameters, options, _ = dump(
                folder / f"{chapter}_point",
                chapter,
                file,
                "--width",
                str(SIZE),
                "--height",
                str(SIZE),
                *point.options.split(),
                "--seed",
                str(FIRST_SEED + index),
            )
            if arrays not in scenes:
                scenes.append(arrays)
            points.append(
                {
                    "at": point.at,
                    "samples": point.samples,
                    "channel": point.channel,
                    "mean": sight.mean,
                    "error": sight.error,
                    "options": options,
                    "scene": scenes.index(arrays),
                    "parameters": parameters,
                }
            )
        shown.append(
            {"name": name, "subject": experiment.subject, "varies": experiment.varies, "when": experiment.when, "points": points}
        )
    # Scenes with the same features share a program.
    stack = max(
        (define for arrays in scenes for define in arrays["defines"] if define.startswith("BVH_STACK_SIZE")),
        key=lambda define: int(define.split()[1]),
        default="",
    )
    for arrays in scenes:
        arrays["defines"] = [stack if define.startswith("BVH_STACK_SIZE") else define for define in arrays["defines"]]
    return {"experiments": shown, "scenes": scenes, "rules": {name: getattr(facts, name) for name in RULES}}


def furnace(folder):
    """A closed room in which every path brings the same light, as chapter 2 weighs by the albedo, 0.5, alone: what is dark there has been lost between triangles."""
    chapter = CHAPTERS[2]
    arrays, parameters, _, _ = dump(folder / "furnace", chapter, "furnace", "--max-path-length", LENGTH, *SIZE_OF_PICTURE)
    return {"chapter": chapter, "scene": arrays, "radiance": 2 - 0.5**LENGTH, "parameters": parameters}


def exercise_of(chapter, texts):
    """The file of exercise 1, and its solution and placeholder; none in a student's tree, where the file has the placeholder."""
    exercise = description(chapter).get("exercise")
    if not exercise:
        return None
    path = f"chapters/{chapter}/{exercise['file']}"
    solution, placeholder = exercise_parts(texts[path], exercise)
    return {"file": path, "find": solution, "replace": placeholder}


def bugs_of(chapter):
    """What each bug of a chapter replaces in its shaders, in the order of ./lab bug; one with two names counts once. A student's tree has none."""
    file = ROOT / "chapters" / chapter / "mistakes.json"
    pieces = [
        (record["find"], record["replace"]) for record in (read_json(file) if file.exists() else []) if "file" not in record
    ]
    return [{"find": find, "replace": replace} for find, replace in dict.fromkeys(pieces)]


def write(folder, frames):
    """Writes the folder `live` of a site. `frames`: {chapter: scenes} of its pages."""
    texts, chapters, scripts = shaders(), {}, {}
    before = dict(pairwise(sorted(frames, reverse=True)))  # the pages' chapters may be compared with
    names = {chapter: pictures_of(chapter, scenes) for chapter, scenes in frames.items()}
    with tempfile.TemporaryDirectory() as temporary, ThreadPoolExecutor() as pool:
        wanted = {
            (each, name) for chapter in frames for name in names[chapter] for each in (chapter, before.get(chapter)) if each
        }
        jobs = {pair: pool.submit(dumped, *pair, Path(temporary)) for pair in sorted(wanted)}
        experiments = {chapter: pool.submit(experiments_of_page, chapter, Path(temporary)) for chapter in frames}
        for chapter in frames:
            told, pictures = description(chapter), []
            for name in names[chapter]:
                entry, files = jobs[chapter, name].result()
                if not fits(files):
                    continue
                pictures.append(entry)
                scripts |= files
                if chapter in before and not jobs[before[chapter], name].exception():  # it may know no glass
                    other, files = jobs[before[chapter], name].result()
                    if fits(files):
                        entry["before"] = {"chapter": before[chapter], "scene": other["scene"], "parameters": other["parameters"]}
                        scripts |= files
            chapters[chapter] = {
                "title": told["title"],
                "strategies": told.get("strategies", []),
                "choices": told.get("choices", []),
                "pictures": pictures,
                "samples": told["check"]["samples"],
                "checked": told["check"]["references"],
                "exercise": exercise_of(chapter, texts),
                "bugs": bugs_of(chapter),
            }
            scripts[f"experiments_{chapter}"] = script(f"experiments_{chapter}", experiments[chapter].result())
        if 2 in CHAPTERS:  # not in the tree of a student who begins
            scripts["furnace"] = script("furnace", furnace(Path(temporary)))
    (folder / "data").mkdir(parents=True)
    for name, text in scripts.items():
        (folder / "data" / f"{name}.js").write_text(text, encoding="utf-8")
    # Later chapters repeat bugs of earlier ones.
    bugs = list({literal(bug): bug for about in chapters.values() for bug in about["bugs"]}.values())
    for about in chapters.values():
        about["bugs"] = [bugs.index(bug) for bug in about["bugs"]]
    (folder / "sources.js").write_text(
        f"var live = {{data: {{}}}};\nlive.sources = {literal(texts)};\nlive.chapters = {literal(chapters)};\n"
        f"const everyBug = {literal(bugs)};\n"
        "for (const about of Object.values(live.chapters)) about.bugs = about.bugs.map(index => everyBug[index]);\n",
        encoding="utf-8",
    )
    for name in [*SCRIPTS, "live.css"]:
        (folder / name).write_text(without_comments((HERE / name).read_text(encoding="utf-8")), encoding="utf-8")
