"""Shows how chapter N's path_trace.glsl differs from the one before: the lesson. Counts what has changed."""
import os
import re
import shutil
import sys
from difflib import SequenceMatcher

from project import CHAPTERS, ROOT, Parser

CONTEXT = 3  # unchanged lines around a change
BEFORE = dict(zip(list(CHAPTERS)[1:], CHAPTERS))  # number of a chapter: that of the one that it is compared with
FUNCTION = 4  # so many equal lines in a row are taken for the same function, not for two that happen to be alike
STYLES = {"-": "\033[31m", "+": "\033[32m", "@": "\033[36m", " ": ""}  # ANSI: red, green, cyan
STRONG, RESET = "\033[7m", "\033[0m"


def shader_lines(number):
    return (ROOT / "chapters" / CHAPTERS[number] / "path_trace.glsl").read_text(encoding="utf-8").splitlines()


def words_of(lines):
    """Names, keywords and numbers of code, without comments."""
    return re.findall(r"[\w.]+", re.sub(r"//.*", "", "\n".join(lines)))


def without_moved(before, after):
    """`before` without what `after` has by a new #include, and pairs (number of lines, file) of what that is."""
    moved, rest = [], before
    for name in re.findall(r'^#include "(.*)"$', "\n".join(line for line in after if line not in before), re.MULTILINE):
        shared = (ROOT / "shaders" / name).read_text(encoding="utf-8").splitlines()
        blocks = SequenceMatcher(None, rest, shared, autojunk=False).get_matching_blocks()
        gone = {i for start, _, size in blocks if size >= FUNCTION for i in range(start, start + size)}
        moved.append((sum(bool(rest[i].strip()) for i in gone), f"shaders/{name}"))
        rest = [line for i, line in enumerate(rest) if i not in gone]
    # Blank lines that stood between moved ones.
    rest = [line for i, line in enumerate(rest) if line.strip() or i == 0 or rest[i - 1].strip()]
    return rest, moved


def is_comment(line):
    return line.strip().startswith("//")


def is_code(line):
    return bool(line.strip()) and not is_comment(line)


def compare(before, after):
    """Rows (mark, line, partner), counts and moved lines. Marks: space the same, - gone, + new. The partner of a line is
    the one that it replaces or is replaced by, if there is one."""
    before, moved = without_moved(before, after)
    rows, counts = [], {"code": 0, "comments": 0, "words": 0}
    for kind, a, b, c, d in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        gone, new = before[a:b], after[c:d]
        if kind == "equal":
            rows += [(" ", line, None) for line in gone]
            continue
        paired = len(gone) == len(new)
        rows += [("-", line, new[i] if paired else None) for i, line in enumerate(gone)]
        rows += [("+", line, gone[i] if paired else None) for i, line in enumerate(new)]
        for key, counted in (("code", is_code), ("comments", is_comment)):  # a line that replaces another is one line
            counts[key] += max(sum(map(counted, gone)), sum(map(counted, new)))
        matcher = SequenceMatcher(None, words_of(gone), words_of(new), autojunk=False)
        counts["words"] += sum(max(j - i, n - m) for tag, i, j, m, n in matcher.get_opcodes() if tag != "equal")
    return rows, counts, moved


def paint(mark, line, partner, colour):
    """A row as text; in colour the words that differ from the partner's stand out."""
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
    """Rows near a change, with None where others are left out."""
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
    print("\n".join(paint(mark, name, None, colour) for mark, name in zip("-+", names)))
    for row in visible(rows):
        print(paint(*row, colour) if row else paint("@", rule, None, True) if colour else "@")


def summary(number, counts, moved):
    text = (f"Chapter {BEFORE[number]} to {number}: {counts['code']} lines of code changed ({counts['words']} words) "
            f"and {counts['comments']} of comments")
    return text + "".join(f"; {count} lines moved to {file}" for count, file in moved if count)


def main():
    parser = Parser("./lab diff", __doc__)
    parser.add_argument("chapter", metavar="N", help="number of a chapter from 2, or 'all' for the counts of every step")
    word = parser.parse_args().chapter
    if word != "all" and (not word.isdigit() or int(word) not in BEFORE):
        sys.exit(f"error: there is no chapter before '{word}' to compare with: N is one of {', '.join(map(str, BEFORE))} or all")
    for number in BEFORE if word == "all" else [int(word)]:
        before, after = map(shader_lines, (BEFORE[number], number))
        rows, counts, moved = compare(before, after)
        if word != "all":
            show([f"chapters/{CHAPTERS[n]}/path_trace.glsl" for n in (BEFORE[number], number)], rows)
        print(summary(number, counts, moved))
