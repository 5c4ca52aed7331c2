"""Proves that ./lab check finds what can go wrong in an exercise: changes its solution in each place, once at a time, and grades it.

    ./lab notebook mutations                 changes the exercises of all chapters
    ./lab notebook mutations --chapters 3    of these alone
    ./lab notebook mutations --list          only prints the changes

Deleted: each statement, factor and addend, each minus and exclamation mark, each function around a value. Inverted: each operator,
comparison and condition. Replaced: each number and component, some functions by their counterparts, and neighbouring arguments by each
other. Where threads start paths one after another: each member of a path kept from the last one. Those that do not compile do not count.
unchanged.json lists those that change nothing, each with why. All others must be found, by ./lab check as a student calls it. With --all-experiments the others are rendered as well, to tell which ones would find what.

Writes its record after each variant, and continues with those that are missing there.
"""
import math
import re
import tempfile
from pathlib import Path
from threading import Lock

from check import grading
from check.diagnosis import is_deciding, observe, too_much_noise
from check.expected import expected_file
from check.experiments import experiments_of
from check.facts import BEYOND_DOUBT, TOLERANCE
from check.submission import Submission
from course.handout import exercise_of, take_out
from course.mistakes import plant
from includes import shaders_of
from learning.learn import digest, own_text
from project import CHAPTERS, ROOT, Parser, UserError, add_device_options, course, name_of, number, read_json, text_of, write_json
from report.batch import run_all

GOES_ON = True
ENDLESS = 5  # seconds for a point of an experiment, most of which take a fifth of one: many changes make a loop endless
LOOP, BOUNCES = "sample_loop.glsl", "extend_path.glsl"
START = "path = start_path(start_sample(position, i, seed));"
UNCHANGED = Path(__file__).with_name("unchanged.json")  # chapter's name -> variant -> why it changes nothing
COUNTERPARTS = {"sin": "cos", "cos": "sin", "min": "max", "max": "min", "x": "y", "y": "x", "z": "y", "xy": "yz", "true": "false"}
INVERSE = {
    " + ": " - ",
    " - ": " + ",
    " * ": " / ",
    " / ": " * ",
    " += ": " -= ",
    " *= ": " /= ",
    " /= ": " *= ",
    " < ": " >= ",
    " > ": " <= ",
    " <= ": " > ",
    " >= ": " < ",
    " == ": " != ",
    " != ": " == ",
    " && ": " || ",
    " || ": " && ",
}
SYMMETRIC = ("dot", "min", "max")  # in their arguments
OPERAND = r"[-!]?(?:\w[\w.]*)?"


def closing(text, begin):
    """The place of the bracket that closes the one at `begin`."""
    depth = 0
    for place in range(begin, len(text)):
        depth += {"(": 1, ")": -1}.get(text[place], 0)
        if depth == 0:
            return place
    raise ValueError(text)


def operand_after(text, begin):
    """The end of the operand of * that begins here."""
    end = begin + len(re.match(OPERAND, text[begin:])[0])
    return closing(text, end) + 1 if text[end : end + 1] == "(" else end


def operand_before(text, end):
    """The beginning of the operand of * that ends here."""
    begin = end
    if text[end - 1] == ")":
        begin = next(place for place in range(end - 1, -1, -1) if text[place] == "(" and closing(text, place) == end - 1)
    return begin - len(re.search(r"[\w.]*$", text[:begin])[0])


def arguments(text, begin):
    """(begin, end) of each argument in the brackets that open at `begin`."""
    end, places, depth = closing(text, begin), [begin + 1], 0
    for place in range(begin + 1, end):
        depth += {"(": 1, ")": -1}.get(text[place], 0)
        if text[place] == "," and not depth:
            places.append(place + 2)
    return list(zip(places, [place - 2 for place in places[1:]] + [end]))


def changes(text):
    """(begin, end, replacement) of each change of a piece of a shader."""
    text = re.sub(r"//.*", lambda comment: " " * len(comment[0]), text)
    for statement in re.finditer(
        r"(?:^|(?<=[;{}\n]))\s*((?:if \(|for \(|[\w.]+ [-+*/]?= |\w+\()[^;{]*;)|(?<=\) )(\w[^;()]*;)", text
    ):
        place = 1 if statement[1] else 2
        yield *statement.span(place), ";"
    for condition in re.finditer(r"if (?=\()", text):
        end = closing(text, condition.end()) + 1
        yield condition.end(), end, f"(!{text[condition.end():end]})"
    for operator in re.finditer(" (?:[-+*/]|[-+*/]=|[<>]=?|[!=]=|&&|[|]{2}) ", text):
        yield *operator.span(), INVERSE[operator[0]]
        if operator[0] in (" * ", " / "):
            yield operator.start(), operand_after(text, operator.end()), ""
            if operator[0] == " * ":
                yield operand_before(text, operator.start()), operator.end(), ""
        elif operator[0] in (" += ", " *= ", " /= "):
            yield *operator.span(), " = "
    for sign in re.finditer(r"(?<=[(, =])[-!](?=[\w(])", text):
        yield *sign.span(), ""
    for literal in re.finditer(r"(?<![\w.])(\d+\.\d+|\d+u)(?!\w)", text):
        digits = literal[0].rstrip("u")
        yield *literal.span(), f"{2 * float(digits) or 1.0:g}.0".replace(".0.0", ".0").replace(
            "5.0", "5"
        ) if "." in digits else f"{int(digits) + 1}u"
    for word in re.finditer(r"\b[a-z]\w*\b", text):
        if word[0] in COUNTERPARTS and (text[word.start() - 1] == "." or word[0] not in "xyz"):
            yield *word.span(), COUNTERPARTS[word[0]]
    for call in re.finditer(r"\b(\w+)\(", text):
        inside = arguments(text, call.end() - 1)
        if call[1] in ("sqrt", "normalize", "abs", "bitfieldReverse", "get_shading_space"):
            yield call.start(), call.end() - 1, ""
        for (begin, end), (next_begin, next_end) in zip(inside, inside[1:]) if call[1] not in SYMMETRIC else []:
            yield begin, next_end, f"{text[next_begin:next_end]}, {text[begin:end]}"


def shader_of(chapter):
    """The file with the chapter's exercise."""
    return ROOT / "chapters" / CHAPTERS[chapter] / exercise_of(chapter)["file"]


def mutations(chapter):
    """Name -> text of the exercise's shader with one change."""
    exercise, text = exercise_of(chapter), text_of(shader_of(chapter))
    _, solution = take_out(text, exercise)
    start, found = text.index(solution), {}
    for begin, end, replacement in changes(solution):
        line = text.count("\n", 0, start + begin) + 1
        name = " ".join(f"{line}: {solution[begin:end].strip()} -> {replacement.strip() or 'nothing'}".split())
        while name in found:  # the same again in this line
            name += "'"
        changed = text[: start + begin] + replacement + text[start + end :]
        if changed != text and changed not in found.values():
            found[name] = changed
    return found


def members(shader):
    """What a path carries from bounce to bounce, by a file with the loop over bounces."""
    found = re.search(r"struct Path \{(.*?)\n\}", text_of(shader), re.DOTALL)
    return re.findall(r"^ +\w+ (\w+);", found[1], re.MULTILINE)


def kept_members(chapter):
    """Name -> (shader, text) of the loop over samples in which a path keeps a member of the last one, where a chapter has such a loop and
    brings it or the path."""
    loops, bounces = ([shader for shader in shaders_of(chapter) if shader.name == name] for name in (LOOP, BOUNCES))
    if not loops or CHAPTERS[chapter] not in {shader.parent.name for shader in (*loops, *bounces)}:
        return {}
    always, found = set.intersection(*map(set, map(members, bounces))), {}
    for member in members(bounces[0]):
        keeping = f"if (i != first) path.{member} = last.{member};"
        if member not in always:  # but in scenes with media
            keeping = f"\n#ifdef FEATURE_MEDIA\n{keeping}\n#endif\n"
        changed = f"{{ Path last = path; {START} {keeping} }}"
        found[f"{LOOP}: kept {member}"] = loops[0], plant(text_of(loops[0]), START, changed, LOOP)
    return found


def certainty(reading):
    """How many times as far from what is expected a reading is as a verdict needs."""
    return abs(reading.value - reading.expected) / (BEYOND_DOUBT * reading.error + 2 * TOLERANCE)


def graded(chapter, shader, text, settings, is_everything):
    """What ./lab check finds: the experiments that are wrong beyond doubt, and if none that decides is, the verdict on the pictures."""
    known = read_json(expected_file(chapter))["experiments"]
    with tempfile.TemporaryDirectory() as folder:
        submission = Submission(chapter, Path(folder) / "mutation.glsl", shader)
        submission.file.write_text(text, encoding="utf-8")
        chosen = (lambda *_: True) if is_everything else is_deciding
        facts, sights = observe(chapter, settings | {"shaders": submission.options, "time_limit": ENDLESS}, known, chosen)
        broken = [seen.sentence for seen in facts.values() if re.search(r"glsl:\d+: ", seen.sentence)]
        if broken:
            return {"compiles": False, "why": broken[0]}
        wrong = {name: round(max(map(certainty, seen.readings), default=math.inf), 2) for name, seen in facts.items()}
        wrong = {name: value for name, value in wrong.items() if value > 1}
        deciding = [name for name in wrong if facts[name].experiment.decides]
        deciding += [name for name, seen in sights.items() if too_much_noise(facts[name].experiment, seen, known[name])]
        answer = {"compiles": True, "deciding": deciding, "wrong": wrong}
        if not deciding:
            try:
                result, pictures = grading.judge(submission, settings)
                if result["verdict"] == "biased" and not wrong:
                    grading.look_closer(submission, settings, result, pictures)
                answer["verdict"] = result["verdict"]
            except UserError as error:
                answer["verdict"] = f"not graded: {error}"
        return answer


def is_found(answer):
    return bool(answer["deciding"]) or answer["verdict"] != "correct"


def all_changes(chapter):
    """Name -> (shader, text) of each change."""
    return {name: (shader_of(chapter), text) for name, text in mutations(chapter).items()} | kept_members(chapter)


def refuse_unless_right(chapter, settings):
    """A machine that renders nothing would find everything."""
    file = shader_of(chapter)
    answer = graded(chapter, file, text_of(file), settings, False)
    if is_found(answer):
        raise UserError(f"{file.relative_to(ROOT)}: unchanged, too, it is not correct: {answer}")


def main():
    parser = Parser("./lab notebook mutations", __doc__)
    parser.add_argument("--chapters", type=number(int, 1), nargs="+", default=course(), metavar="N", help="default: all")
    parser.add_argument("--jobs", type=number(int, 1), default=1, help="shaders that are graded at a time; default: 1")
    parser.add_argument("--list", action="store_true", help="only print the changes")
    parser.add_argument("--all-experiments", action="store_true", help="render those that do not decide as well")
    parser.add_argument(
        "--output",
        type=Path,
        default=ROOT / "output/mutations.json",
        metavar="FILE",
        help="the record; default: output/mutations.json",
    )
    add_device_options(parser)
    options = parser.parse_args()
    grading.stay_in_the_driver(options.backend)
    settings = {
        "backend": options.backend,
        "device": options.device,
        "time_limit": 20,
        "runs": grading.RUNS,
        "samples": None,
        "first_seed": grading.first_seed(0),
        "is_quiet": True,
    }
    everything = {
        (chapter, name): where_and_what for chapter in options.chapters for name, where_and_what in all_changes(chapter).items()
    }
    if options.list:
        print("\n".join(f"{chapter} {name}" for chapter, name in everything))
        return
    run_all("unchanged shaders", lambda chapter: refuse_unless_right(chapter, settings), options.chapters, options.jobs)
    record, lock = read_json(options.output) if options.output.exists() else {}, Lock()

    def grade(item):
        (chapter, name), (shader, text) = item
        key, stamp = f"{chapter} {name}", digest(text, options.all_experiments, repr(experiments_of(chapter)), own_text(chapter))
        if record.get(key, {}).get("stamp") != stamp:
            answer = graded(chapter, shader, text, settings, options.all_experiments) | {"stamp": stamp}
            with lock:
                record[key] = answer
                options.output.parent.mkdir(exist_ok=True)
                write_json(options.output, record)

    run_all("mutations", grade, list(everything.items()), options.jobs)
    unchanged = read_json(UNCHANGED) if UNCHANGED.exists() else {}
    for chapter in options.chapters:
        answers = {name: record[f"{chapter} {name}"] for number, name in everything if number == chapter}
        counted = {
            name: answer
            for name, answer in answers.items()
            if answer["compiles"] and name not in unchanged.get(name_of(chapter), {})
        }
        missed = [name for name, answer in counted.items() if not is_found(answer)]
        print(f"chapter {chapter}: {len(counted) - len(missed)} of {len(counted)} found", *missed, sep="\n  ")
