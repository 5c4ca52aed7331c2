"""Shared by the tools: locations, command lines, progress, records and tables."""
import argparse
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BINARIES = Path(os.environ.get("LAB_BINARIES", ROOT / "build/bin"))
KNOWLEDGE = (
    ROOT / "notebook/knowledge"
)  # the only path from here into the notebook: what ./lab check knows about mistakes, if it is there
CHAPTERS = {int(path.name[:2]): path.name for path in sorted((ROOT / "chapters").glob("[0-9][0-9]_*"))}  # number -> folder
VARIANTS = {"scalar_rgb": "scalar", "llvm_ad_rgb": "LLVM", "cuda_ad_rgb": "CUDA"}  # of Mitsuba, the slowest first
BAR_WIDTH = 24
ROW = 1000  # characters of a line of JSON: the longest row of a record has 740
INSTALL = "./lab install" if os.name == "posix" else "python -m pip install numpy scipy matplotlib pillow"


def program_file(name):
    """The file of a program that the lab has built."""
    return (BINARIES / name).with_suffix("" if os.name == "posix" else ".exe")


def ensure_packages():
    """Starts the running program again in Debian's Python if this one lacks what ./lab install installs for that one."""
    debians = Path("/usr/bin/python3")
    if not all(map(find_spec, ("matplotlib", "numpy", "PIL", "scipy"))) and sys.executable != str(debians) and debians.exists():
        os.execv(debians, [debians, *sys.orig_argv[1:]])


class UserError(Exception):
    """Bad input: one line that says what is wrong, where, and what to do."""


def name_of(number):
    """The name of a chapter, which persists if its number changes."""
    return CHAPTERS[number][3:]


def chapter_named(name):
    """The folder of the chapter with this name, whatever its number."""
    return next(folder for folder in CHAPTERS.values() if folder[3:] == name)


def description(folder):
    """A chapter's chapter.json."""
    file = ROOT / "chapters" / folder / "chapter.json"
    try:
        return read_json(file)
    except ValueError as error:
        raise UserError(f"{file}: not valid JSON: {error}") from None


def rendered_description(folder):
    """What chapter.json says about renders, as text: without what only tests and tools read."""
    return json.dumps(
        {key: value for key, value in description(folder).items() if key not in ("check", "exercise", "tests", "measure")}
    )


def original(number):
    """The number of the chapter that this one copies, judged by its title, or else its own."""
    title = description(CHAPTERS[number])["title"]
    return next(other for other in CHAPTERS if description(CHAPTERS[other])["title"] == title)


def course():
    """The numbers of all chapters that are not copies of another."""
    return [number for number in CHAPTERS if original(number) == number]


def text_of(file):
    """The text of a source. A student's editor may have saved it in the encoding of Windows, or with a byte order mark."""
    try:
        return file.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        return file.read_text(encoding="cp1252", errors="replace")


def has_low_discrepancy(program):
    """Whether the samples of a pixel are correlated, given a chapter's folder, a copy of its program, or anything else."""
    folder = Path(program).stem
    return folder in CHAPTERS.values() and description(folder).get("low_discrepancy", False)


def printable(name):
    """A path or name as printable text: some, from archives of other systems, are not UTF-8."""
    return os.fsencode(name).decode("utf-8", "backslashreplace")


# ---------------------------------------------------------------------------------------------- command lines
class Parser(argparse.ArgumentParser):
    """`name` is the command's name, `description` the text above its options."""

    def __init__(self, name, description, **options):
        super().__init__(prog=name, description=description, formatter_class=argparse.RawDescriptionHelpFormatter, **options)

    def error(self, message):
        sys.exit(f"error: {message}; {self.prog} --help lists the options")


def number(kind, low, high=1e9):
    """Converts an argument to a number of this kind between `low` and `high`."""

    def convert(text):
        value = kind(text)
        if not low <= value <= high:
            raise ValueError
        return value

    convert.__name__ = f"number from {low:g} to {high:g}"
    return convert


def add_device_options(parser):
    parser.add_argument(
        "--backend", default="auto", metavar="NAME", help="one that --list-devices of a chapter shows; default: auto"
    )
    parser.add_argument("--device", help="number or part of the name of the device")


def run_tool(tool):
    """Calls a module's main(), and reports failures to the user in one line. A tool with GOES_ON, when called again after an
    interruption, does only what is left."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        tool.main()
        sys.stdout.flush()
    except BrokenPipeError:  # nobody reads any more, as in ./lab diff 5 | head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for what Python still has to write
        sys.exit(1)
    except (UserError, OSError) as error:
        sys.exit(f"error: {error}")
    except KeyboardInterrupt:
        sys.exit("interrupted" + (": the same command goes on" if getattr(tool, "GOES_ON", False) else ""))


# ---------------------------------------------------------------------------------------------- programs
def run_program(command, **options):
    """Runs a program without input and captures its output. Ctrl-C does not reach it, since it has its own session."""
    return subprocess.run(
        list(map(str, command)),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        **{"cwd": ROOT, "encoding": "utf-8", "errors": "backslashreplace", "start_new_session": True, **options},
    )


def run_to_end(command, what, expected=0, **options):
    """The output of a program that must end with this exit code. `what` describes its task in messages."""
    process = run_program(command, **options)
    if process.returncode != expected:
        raise UserError(
            f"{what}: exit code {process.returncode} instead of {expected}:\n{process.stdout[-2000:]}{process.stderr[-2000:]}"
        )
    return process.stdout


def failure_text(process):
    """The message of a program that failed: the first line of its error, from which others may follow, or else its last line."""
    lines = process.stderr.strip().split("\n")
    return (
        next((line.removeprefix("error: ") for line in lines if line.startswith("error: ")), lines[-1])
        or f"exit code {process.returncode}"
    )


def commit():
    """The commit of the sources, or 'unknown' outside a repository."""
    try:
        git = run_program(["git", "describe", "--always", "--dirty= with changes", "--abbrev=7", "--exclude=*"])
    except OSError:
        return "unknown"
    return git.stdout.strip() or "unknown"


# ---------------------------------------------------------------------------------------------- progress
def duration_text(seconds):
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.1f} minutes"


def show_progress(name, done, count, started):
    """`done` of `count` equal steps, the first of which started at `started` by time.monotonic(): on a terminal a bar with the
    time left, elsewhere a few plain lines."""
    left = duration_text((time.monotonic() - started) * (count - done) / max(done, 1))
    if sys.stderr.isatty():
        filled = BAR_WIDTH * done // count
        bar = "#" * filled + "-" * (BAR_WIDTH - filled)
        print(
            f"\r\033[K[{bar}] {100 * done // count} %, {left} left: {name}",
            end="\n" if done == count else "",
            file=sys.stderr,
            flush=True,
        )
    elif done in (1, count) or 4 * done // count > 4 * (done - 1) // count:
        print(f"{100 * done // count} %, {left} left: {name}", file=sys.stderr, flush=True)


# ---------------------------------------------------------------------------------------------- files and tables
def read_json(file):
    return json.loads(file.read_text(encoding="utf-8"))


def write_bytes(file, content):
    """Writes a file and creates its folder. The file is complete at all times, and keeps its mode; symbolic links are followed."""
    file = file.resolve()
    file.parent.mkdir(parents=True, exist_ok=True)
    unfinished = file.with_name(file.name + ".unfinished")
    unfinished.touch()
    if file.exists():
        shutil.copymode(file, unfinished)
    unfinished.write_bytes(content)
    os.replace(unfinished, file)


def write_json(file, content, width=ROW):
    """Writes JSON whose lines have this many characters at most, if what they hold can be divided."""
    write_bytes(file, (json_rows(content, width) + "\n").encode())


def json_rows(content, width=ROW, indent="\n", key=""):
    """JSON with a row a line: what fits into a line takes a single one, and plain values of a larger object or list share lines."""
    text, is_object = json.dumps(content, ensure_ascii=False), isinstance(content, dict)
    if len(indent + key + text) <= width or is_plain(content):
        return key + text
    rows, last = [], content
    for name, item in content.items() if is_object else enumerate(content):
        row = json_rows(item, width, indent + " ", f"{json.dumps(name, ensure_ascii=False)}: " if is_object else "")
        if is_plain(item) and is_plain(last) and len(f"{indent} {rows[-1]}, {row}") <= width:
            rows[-1] += f", {row}"
        else:
            rows.append(row)
        last = item
    return key + text[0] + ",".join(f"{indent} {row}" for row in rows) + indent + text[-1]


def is_plain(value):
    """Whether a value of JSON holds no others."""
    return not value or not isinstance(value, (dict, list))


def scene_of(name):
    """The scene's name in a reference's name, which ends with numbers."""
    return name.rstrip("_0123456789")


def table(head, rows, left=1):
    """A Markdown table whose first `left` columns are text and the others numbers."""
    ruler = ["---"] * left + ["---:"] * (len(head) - left)
    return "".join("| " + " | ".join(cells) + " |\n" for cells in [head, ruler, *rows])
