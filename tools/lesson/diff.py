"""Shows the lesson of chapter N: how its path_trace.glsl differs from that of the previous chapter, and the other shaders that its
folder adds, in full. Counts what is new. A copy of a chapter is compared with this chapter, as long as it has the same title.
"""
import os
import re
import shutil
import sys
from collections import Counter
from difflib import SequenceMatcher

from includes import included, named_files
from project import CHAPTERS, ROOT, Parser, original, text_of

CONTEXT = 3  # unchanged lines around a change
# Number of a chapter: that of the one to compare it with.
BEFORE = {
    number: previous if original(number) == number else original(number) for previous, number in zip(CHAPTERS, list(CHAPTERS)[1:])
}
STYLES = {"-": "\033[31m", "+": "\033[32m", "@": "\033[36m", " ": ""}  # ANSI: red, green, cyan
STRONG, RESET = "\033[7m", "\033[0m"
ESTIMATOR = re.compile(r"^vec3 path_trace\(", re.MULTILINE)


def shader_lines(file, named=None):
    """The lines of a shader, given by its path below the project's folder; none if there is no such file. If it includes its namesake, or
    a file with the function path_trace(), the included lines follow, so that chapters are compared as if each were written in full.
    """
    path, lines = (ROOT / file).resolve(), []
    named = named or named_files(path.parent)
    for line in text_of(path).splitlines() if path.is_file() else []:
        lines.append(line)
        target = included(line, path, named)
        if target and target != path and (target.name == path.name or ESTIMATOR.search(text_of(target))):
            lines += shader_lines(target, named)
    return lines


def lesson(number):
    """(file before, file) for each shader of a chapter's folder, the estimator first."""
    folder, before = (ROOT / "chapters" / CHAPTERS[each] for each in (number, BEFORE[number]))
    # A file with that function is part of the estimator.
    names = ["path_trace.glsl", *(path.name for path in sorted(folder.glob("*.glsl")) if not ESTIMATOR.search(text_of(path)))]
    named = named_files(before)
    return [
        [path.relative_to(ROOT).as_posix() for path in (named.get(name, before / name), folder / name)]
        for name in dict.fromkeys(names)
    ]


def words_of(lines):
    """Names, keywords and numbers in code, without comments."""
    return re.findall(r"[\w.]+", re.sub(r"//.*", "", "\n".join(lines)))


def is_comment(line):
    return line.strip().startswith("//")


def is_code(line):
    return bool(line.strip()) and not is_comment(line)


def compare(before, after):
    """Rows (mark, line, partner) and counts. Marks: space for equal lines, - for removed and + for new ones. A line's partner is
    the one that it replaces, or that replaces it."""
    rows, counts = [], {"code": 0, "comments": 0, "words": 0}
    for kind, a, b, c, d in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        gone, new = before[a:b], after[c:d]
        if kind == "equal":
            rows += [(" ", line, None) for line in gone]
            continue
        paired = len(gone) == len(new)
        rows += [("-", line, new[i] if paired else None) for i, line in enumerate(gone)]
        rows += [("+", line, gone[i] if paired else None) for i, line in enumerate(new)]
        for key, counted in (("code", is_code), ("comments", is_comment)):  # a line that replaces another counts once
            counts[key] += max(sum(map(counted, gone)), sum(map(counted, new)))
        matcher = SequenceMatcher(None, words_of(gone), words_of(new), autojunk=False)
        counts["words"] += sum(max(j - i, n - m) for tag, i, j, m, n in matcher.get_opcodes() if tag != "equal")
    return rows, counts


def paint(mark, line, partner, colour):
    """A row as text; in colour, words that differ from the partner are highlighted."""
    if not colour:
        return f"{mark} {line}".rstrip()
    if partner is None:
        return f"{STYLES[mark]}{mark} {line}{RESET}"
    mine, other = re.split(r"(\W)", line), re.split(r"(\W)", partner)
    text = ""
    for tag, i, j, _, _ in SequenceMatcher(None, mine, other, autojunk=False).get_opcodes():
        piece = "".join(mine[i:j])
        text += piece if tag == "equal" else f"{STRONG}{piece}{RESET}{STYLES[mark]}"
    return f"{STYLES[mark]}{mark} {text}{RESET}"


def visible(rows):
    """The rows near a change, with None in place of omitted ones."""
    near = {j for i, row in enumerate(rows) if row[0] != " " for j in range(i - CONTEXT, i + CONTEXT + 1)}
    shown = [i for i in range(len(rows)) if i in near]
    for previous, i in zip([-1, *shown], shown):
        if i > previous + 1:
            yield None
        yield rows[i]


def show(names, rows):
    """Prints rows of compare() under the names of the two files."""
    colour = sys.stdout.isatty() and "NO_COLOR" not in os.environ
    rule = "." * min(shutil.get_terminal_size().columns, 120)
    print("\n".join(paint(mark, name, None, colour) for mark, name in zip("-+", names) if (ROOT / name).is_file()))
    for row in visible(rows):
        print(paint(*row, colour) if row else paint("@", rule, None, True) if colour else "@")


def main():
    parser = Parser("./lab diff", __doc__)
    parser.add_argument("chapter", metavar="N", help="number of a chapter from 2, or 'all' for the counts of every step")
    word = parser.parse_args().chapter
    if word != "all" and (not word.isdigit() or int(word) not in BEFORE):
        sys.exit(f"error: there is no chapter before '{word}' to compare with: N is one of {', '.join(map(str, BEFORE))} or all")
    for number in BEFORE if word == "all" else [int(word)]:
        total = Counter()
        for files in lesson(number):
            rows, counts = compare(*map(shader_lines, files))
            total.update(counts)
            if word != "all":
                show(files, rows)
        print(
            f"Chapter {BEFORE[number]} to {number}: {total['code']} lines of code changed ({total['words']} words) "
            f"and {total['comments']} of comments"
        )
