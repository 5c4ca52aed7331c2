"""How large is each part? Lines of its text files: sources, pages and data, but neither pictures nor records.

With a commit, such as v1.0.0, those of that commit beside them.
"""
import re
import subprocess

from project import ROOT, Parser, UserError, table

PARTS = {  # name: its files; the first part that has a file counts it
    "course, C++": r"common/(?!app/|viewer/|inside/|inspection/|native/).*\.(h|cpp)$",
    "app": r"common/app/.*\.(h|cpp)$",
    "annex: window, views": r"common/(viewer|inside|inspection)/.*\.(h|cpp)$",
    "annex: native": r"common/native/.*\.(h|cpp)$",
    "shaders": r"shaders/",
    "chapters, shaders": r"chapters/[^/]+/[^/]+\.glsl$",
    "chapters, JSON": r"chapters/[^/]+/[^/]+\.json$",
    "chapters, pages and solutions": r"chapters/[^/]+/(README\.md|solutions/)",
    "tools": r"(tools/|lab$)",
    "notebook, records": r"(notebook|docs)/records/",
    "notebook, knowledge and submissions": r"(notebook/(knowledge|submissions|variants)/|chapters/.*(variants/|knowledge\.json)|tests/submissions/|assets/expected/)",
    "notebook, rest": r"(notebook/|docs/results/)",
    "tests": r"tests/",
    "docs, pages": r"(docs/.*\.md$|[A-Z]+\.md$)",
}
NO_TEXT = re.compile(r"\.(exr|hdr|png|jpg|webp|bmp|tga|svg)$")


def git(*arguments):
    process = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True)
    if process.returncode:
        raise UserError(process.stderr.decode().strip().split("\n")[0])
    return process.stdout


def lines_of(commit):
    """{part: number of lines} in a commit, or in the working tree if it is empty."""
    names = git(*(["ls-tree", "-r", "--name-only", commit] if commit else ["ls-files"])).decode().splitlines()
    counts = dict.fromkeys(PARTS, 0)
    for name in names:
        part = next((part for part, pattern in PARTS.items() if re.match(pattern, name)), None)
        if part and not NO_TEXT.search(name):
            content = (
                git("show", f"{commit}:{name}") if commit else (ROOT / name).read_bytes() if (ROOT / name).is_file() else b""
            )
            counts[part] += content.count(b"\n")
    return counts


def main():
    parser = Parser("./lab notebook sizes", __doc__)
    parser.add_argument("commit", nargs="?", help="to compare with")
    commit = parser.parse_args().commit
    columns = {**({commit: lines_of(commit)} if commit else {}), "now": lines_of("")}
    print(table(["part", *columns], [[part, *(f"{lines[part]:,}" for lines in columns.values())] for part in PARTS]), end="")
