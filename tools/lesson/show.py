"""Shows the whole estimator of chapter N as one text, in the order in which the compiler reads it. The name of its file stands above each
part. What the scene does not compile is left out, and so is the engine's own text, which all chapters share: shaders/.
"""
import re
import tempfile
from itertools import groupby
from pathlib import Path

from includes import included, named_files
from project import (
    CHAPTERS,
    ROOT,
    Parser,
    UserError,
    description,
    failure_text,
    number,
    original,
    program_file,
    read_json,
    run_program,
    text_of,
)

ENGINE = ROOT / "shaders/engine/render_samples.glsl"  # what all backends compile
DIRECTIVE = re.compile(r" *# *(if|ifdef|ifndef|elif|else|endif|define|undef)\b *(.*)")
TERM = re.compile(r"(!?) *(?:defined *\( *)?(\w+)")
CODE = re.compile(r"^(?! *//)(?! *#include).*\S", re.MULTILINE)


def defines_of(chapter, scene):
    """The names that a program defines to render a scene, for each of which a chapter may ask by #ifdef."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scene"
        process = run_program([program_file("dump_arrays"), file, CHAPTERS[original(chapter)], scene])
        if process.returncode != 0:
            raise UserError(failure_text(process).removeprefix("error: "))
        arrays = read_json(file.with_suffix(".json"))
    return {define.split()[0] for define in arrays["defines"] + arrays["options"]}


def holds(word, condition, defines):
    """Whether the condition of an #if, which asks what is defined, or of an #ifdef or #ifndef."""
    terms = [[TERM.match(term.strip()).groups() for term in part.split("&&")] for part in condition.split("||")]
    return any(all((name in defines) != bool(inverse) for inverse, name in part) for part in terms) != (word == "ifndef")


def compiled_lines(file, named, defines, done, is_compiled=True):
    """(file, line) for each line that a compiler reads of a file and of what it includes. `defines` and `done`, the files read so far, grow."""
    done.add(file)
    levels = [(is_compiled, True)]  # of each #if: whether these lines are compiled, whether any branch so far was
    for line in text_of(file).splitlines():
        word, rest = match.groups() if (match := DIRECTIVE.match(line)) else ("", "")
        if word in ("if", "ifdef", "ifndef"):
            levels.append((levels[-1][0] and holds(word, rest, defines),) * 2)
        elif word in ("elif", "else"):
            _, is_done = levels.pop()
            is_next = levels[-1][0] and not is_done and (word == "else" or holds(word, rest, defines))
            levels.append((is_next, is_done or is_next))
        elif word == "endif":
            levels.pop()
        elif target := included(line, file, named):
            if target not in done:  # each once, even if an #if skips it
                yield from compiled_lines(target, named, defines, done, levels[-1][0])
        elif levels[-1][0]:
            if word:
                (defines.add if word == "define" else defines.discard)(rest.split()[0])
            yield file, line


def parts_of(chapter, scene):
    """(file, text) of the parts of a chapter's estimator, without files of which nothing is compiled, unless they only explain."""
    chapters, defines = ROOT / "chapters", defines_of(chapter, scene)
    lines = compiled_lines(ENGINE, named_files(chapters / CHAPTERS[chapter]), defines, set())
    groups = groupby((pair for pair in lines if pair[0].is_relative_to(chapters)), key=lambda pair: pair[0])
    parts = [(file, re.sub(r"\n{3,}", "\n\n", "\n".join(line for _, line in group).strip("\n"))) for file, group in groups]
    used = {file for file, text in parts if CODE.search(text) or not CODE.search(text_of(file))}
    return [(file, text) for file, text in parts if text and file in used]


def listing(chapter, scene=None):
    """The parts as one text."""
    scene = scene or description(CHAPTERS[chapter]).get("default_scene", "cornell_box")
    return "\n".join(
        f"// ======== {file.relative_to(ROOT / 'chapters').as_posix()} ========\n{text}\n"
        for file, text in parts_of(chapter, scene)
    )


def main():
    parser = Parser("./lab show", __doc__)
    parser.add_argument("chapter", type=number(int, 1), metavar="N", help="number of the chapter")
    parser.add_argument(
        "scene", nargs="?", metavar="SCENE", help="a scene file, or the name of one in assets/scenes; default: the chapter's own"
    )
    options = parser.parse_args()
    if options.chapter not in CHAPTERS:
        raise UserError(f"there is no chapter {options.chapter}; ./lab run lists them")
    print(listing(options.chapter, options.scene), end="")
