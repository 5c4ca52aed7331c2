"""Grades all shaders of a folder: ./lab check N --all FOLDER."""
import csv
import hashlib
import html
import json
import sys
import time
from collections import Counter
from functools import cache
from pathlib import Path
from string import Template
from urllib.parse import quote

from check.expected import DESCRIPTIONS, known_mistakes
from check.submission import Submission
from check.words import detail_lines, headline, laid_out, questions, short_lines
from project import CHAPTERS, ROOT, UserError, course, printable, read_json, write_json
from report.measurement import digest_of_sources

UNGRADED = 2  # exit code
NO_SUBMISSION = (".", "__MACOSX")  # what names begin with in archives of other systems
MOST_COMMON = 5  # number of causes that sum up a class
NAMELESS = "no single common mistake fits; they may differ: see what was seen of each"
COLUMNS = ["submission", "verdict", "unfinished_line", "facts", "mistakes", "questions", "error", "seconds"]
PAGE = Template(Path(__file__).with_name("page.html").read_text(encoding="utf-8"))


def submissions(folder, output):
    """Name -> path of each submission in a folder: a file NAME.glsl or a folder NAME. `output` is none of them."""
    if not folder.is_dir():
        raise UserError(f"{folder}: no such folder")
    found = {}
    for path in sorted(folder.iterdir(), key=lambda path: (not path.is_dir(), path)):
        if not path.name.startswith(NO_SUBMISSION) and path.resolve() != output and (path.is_dir() or path.suffix == ".glsl"):
            name = printable(path.name if path.is_dir() else path.stem)
            while name in found:  # of a folder
                name += ".glsl"
            found[name] = path
    if not found:
        raise UserError(f"{folder}: has neither files NAME.glsl nor folders NAME with a shader")
    return dict(sorted(found.items()))


def shader_of(path, chapter):
    """The file to be graded of what was handed in. In a folder it is the exercise's shader, or else the only one."""
    if not path.is_dir():
        return path
    wanted = DESCRIPTIONS[chapter].get("exercise", {}).get("file", "path_trace.glsl")  # a student's tree does not say it

    def distance(file):  # some hand in the whole tree
        return file.name != wanted, file.parent.name != CHAPTERS[chapter], len(file.parts)

    files = sorted(file for file in path.rglob("*.glsl") if file.is_file() and not file.name.startswith(NO_SUBMISSION))
    shaders = sorted(files, key=distance)
    if not shaders:
        raise UserError(f"has no shader: {wanted} is missing")
    if len(shaders) > 1 and distance(shaders[0]) == distance(shaders[1]):
        names = " and ".join(printable(file.relative_to(path)) for file in shaders[:2])
        raise UserError(f"has {len(shaders)} shaders, such as {names}: which one is {wanted}?")
    return shaders[0]


@cache
def sources_of(chapter):
    """Digests of what is the same for all submissions."""
    return digest_of_sources([]), hashlib.sha256(json.dumps(known_mistakes(chapter)).encode()).hexdigest()


def digest(options, submission):
    """A digest of a submission and everything it is graded with: results with the same digest are kept."""
    settings = [
        sources_of(options.chapter),
        options.chapter,
        options.seed,
        options.runs,
        options.samples,
        options.teacher,
        options.backend,
        options.device,
    ]
    shaders = {printable(each.name): each.read_bytes().hex() for each in submission.files}
    return hashlib.sha256(json.dumps([settings, submission.file.name, shaders]).encode()).hexdigest()


def grade_one(options, check, name, path, folder, known):
    """The row of a submission, which is the known one if that has the same digest."""
    started, key = time.monotonic(), None
    try:
        submission = Submission(options.chapter, shader_of(path, options.chapter))
        key = digest(options, submission)
        if known and known["digest"] == key and known["verdict"] != "not graded":
            return known
        result = check(options, submission, folder / f"{name}.png")
        found = result["diagnosis"] or {"facts": [], "mistakes": [], "fits": False}
        fitting = found["mistakes"] if found["fits"] else []
        row = {
            "verdict": headline(result)[0],
            "unfinished_line": result["unfinished_line"],
            "picture": f"{name}.png",
            "headline": headline(result),
            "text": laid_out(short_lines(result)),
            "details": laid_out(detail_lines(result)),
            "facts": " | ".join(fact["text"] for fact in found["facts"]),
            "mistakes": " ".join(each.get("name", "") for each in fitting),
            "questions": " ".join(questions(result) if fitting else []),
            "causes": causes(options.chapter, result),
            "error": "",
        }
    except Exception as error:  # whatever it is, grading continues with the next submission
        text = printable(str(error))
        row = {
            "verdict": "not graded",
            "headline": ("not graded", text),
            "error": text,
            "text": text,
            "details": "",
            "causes": [],
        }
    return {"submission": name, **row, "seconds": round(time.monotonic() - started, 1), "digest": key}


def in_a_table(value):
    """Spreadsheets interpret a text that begins like this as a formula."""
    return f"'{value}" if str(value)[:1] in ("=", "+", "-", "@") else value


def causes(chapter, result):
    """What is wrong with a shader, for the summary of a class: the mistakes that fit, each with the fact that speaks for it most and
    the chapter that teaches what it gets wrong."""
    found = result["diagnosis"]
    if result["unfinished_line"]:
        return ["unfinished: a TODO is left"]
    if result["verdict"] == "correct" or not found:
        return []
    if not (found["fits"] and questions(result)):  # what has no name may be a mistake of its own
        return [NAMELESS]
    pages = [
        f"{mistake['slide'] or mistake['section']}; chapters/{CHAPTERS[teaching(chapter, mistake)]}/README.md"
        for mistake in found["mistakes"]
    ]
    return [f"{question} ({page})" for question, page in zip(questions(result), pages)]


def teaching(chapter, mistake):
    """The first chapter whose shader can have this mistake."""
    knowledge = {number: known_mistakes(number) for number in course() if number < chapter}
    return next(
        (number for number, known in knowledge.items() if mistake["hint"] in {each["hint"] for each in known.values()}), chapter
    )


def summary(rows):
    """What is wrong most often in a class, as lines, each with the first fact about one of these shaders."""
    counts = Counter(cause for row in rows for cause in row["causes"])
    nameless = counts.pop(NAMELESS, 0)
    facts = {cause: row["facts"].split(" | ")[0] for row in reversed(rows) for cause in row["causes"]}
    return [
        f"{count} of {len(rows)}: {cause}{': ' if facts[cause] else ''}{facts[cause]}"
        for cause, count in counts.most_common(MOST_COMMON)
    ] + [f"{nameless} of {len(rows)}: {NAMELESS}"] * bool(nameless)


def write_page(options, rows, path):
    """A table of all submissions, and a section about each."""
    escaped = [{key: html.escape(row[key]) for key in ("submission", "verdict", "text", "details")} for row in rows]
    lines = [
        f'<tr><td><a href="#{i}">{row["submission"]}</a></td><td>{row["verdict"]}</td><td>{html.escape(rows[i]["headline"][1])}</td></tr>\n'
        for i, row in enumerate(escaped)
    ]
    body = f"<table>\n<tr><th>submission</th><th>verdict</th><th></th></tr>\n{''.join(lines)}</table>\n"
    if common := summary(rows):
        body += f"<h2>What is wrong most often</h2>\n<pre>{html.escape(chr(10).join(common))}</pre>\n"
    for i, row in enumerate(escaped):
        picture = f'<img src="{quote(rows[i]["picture"])}" alt="pictures and differences">' if rows[i].get("picture") else ""
        details = f"<details><summary>Details</summary><pre>{row['details']}</pre></details>\n" if row["details"] else ""
        body += f'<h2 id="{i}">{row["submission"]}: {row["verdict"]}</h2>\n{picture}<pre>{row["text"]}</pre>\n{details}'
    path.write_text(PAGE.substitute(title=f"Chapter {options.chapter}: {len(rows)} submissions", body=body), encoding="utf-8")


def grade_all(options, check):
    """Grades everything not graded yet and updates the table and the page after each shader. Returns the exit code."""
    folder = (options.output or ROOT / f"output/check_{options.chapter}").resolve()
    folder.mkdir(parents=True, exist_ok=True)
    record = folder / "results.json"
    known = read_json(record) if record.exists() else {}
    rows, found = [], submissions(options.folder, folder)
    for done, (name, path) in enumerate(found.items(), 1):
        options.what = f"{done} of {len(found)}, {name}: "
        row = grade_one(options, check, name, path, folder, known.get(name))
        if row is not known.get(name):
            known[name] = row
            write_json(record, known)
        rows.append(known[name])
        print(f"{done} of {len(found)}: {name}: {known[name]['verdict']}", flush=True)
        with open(folder / "results.csv", "w", newline="", encoding="utf-8-sig") as table:
            writer = csv.DictWriter(table, COLUMNS, extrasaction="ignore")
            writer.writeheader()
            writer.writerows({key: in_a_table(value) for key, value in row.items()} for row in rows)
        write_page(options, rows, folder / "index.html")
    if common := summary(rows):
        print("\n".join(["what is wrong most often", *common]))
    print(f"{folder / 'results.csv'}\n{folder / 'index.html'}", file=sys.stderr)
    return UNGRADED if any(row["verdict"] == "not graded" for row in rows) else 0
