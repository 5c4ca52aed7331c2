"""Stops in a shader: runs one sample of one pixel of chapter N in a debugger, up to its path_trace(), or to
extend_path() where the chapter has a loop over samples of its own.

    ./lab debug 3 --pixel 200,300                   gdb, or lldb if there is no gdb
    ./lab debug 3 torus --pixel 20,30 --sample 5    all other options are the chapter's
    ./lab debug 1 -- -batch -ex 'break 29' -ex continue -ex 'info locals'    passes what follows -- to the debugger
    ./lab debug --vscode                            writes .vscode/launch.json and .vscode/tasks.json, to press F5 there

docs/debugging.md, which handouts leave out, shows what you can do there.
"""
import json
import os
import shutil
import sys

from includes import named_files
from project import CHAPTERS, ROOT, Parser, UserError, number, program_file

SETTINGS = [
    "set breakpoint pending on",
    "set print thread-events off",
    "set debuginfod enabled off",
    # Stepping does not enter the functions that implement GLSL's own.
    "skip -gfi */glm/*",
    "skip -gfi */native/glsl.h",
]
PRINTERS = "tools/debug/printers.py"


def parse():
    arguments, _, debugger = (list(part) for part in partition(sys.argv[1:], "--"))
    parser = Parser("./lab debug", __doc__)
    parser.add_argument("chapter", type=number(int, 1), nargs="?", metavar="N", help="number of the chapter")
    parser.add_argument(
        "--pixel", metavar="X,Y", help="the pixel, counted from the upper left corner; default: the middle of 512 x 512"
    )
    parser.add_argument(
        "--sample", type=number(int, 0, 2**32 - 1), default=0, metavar="I", help="index of the sample; default: 0"
    )
    parser.add_argument("--vscode", action="store_true", help="write the files for Visual Studio Code")
    options, chapter_options = parser.parse_known_args(arguments)
    return options, chapter_options, debugger


def partition(words, separator):
    i = words.index(separator) if separator in words else len(words)
    return words[:i], words[i : i + 1], words[i + 1 :]


def first_function(chapter):
    """Where to stop: a chapter with a loop over samples of its own never calls path_trace(), but extends paths by itself."""
    chapters = ROOT / "chapters"
    return "extend_path" if named_files(chapters / chapter)["sample_loop.glsl"].is_relative_to(chapters) else "path_trace"


def command_for(debugger, program, arguments, extra, function="path_trace"):
    """The debugger's command line: it has stopped in that function when it processes `extra`."""
    if debugger.endswith("lldb"):
        return [debugger, *extra, "-o", f"breakpoint set --name {function}", "-o", "process launch", "--", program, *arguments]
    start = [word for line in [*SETTINGS, f"source {ROOT / PRINTERS}", f"break {function}", "run"] for word in ("-ex", line)]
    batch = [word for word in extra if word == "-batch"]  # must precede what it is to run
    return [debugger, "-q", *batch, *start, *(word for word in extra if word != "-batch"), "--args", program, *arguments]


def vscode_files():
    """The files in .vscode/ by their names."""
    chapters = list(CHAPTERS.values())
    inputs = [
        {"id": "chapter", "type": "pickString", "description": "chapter", "options": chapters, "default": chapters[0]},
        {"id": "scene", "type": "promptString", "description": "scene", "default": "cornell_box"},
        {"id": "pixel", "type": "promptString", "description": "pixel X,Y", "default": "256,256"},
    ]
    setup = [
        {"text": f'-interpreter-exec console "{line}"'}
        for line in [*SETTINGS, f"source ${{workspaceFolder}}/{PRINTERS}", "break path_trace", "break extend_path"]
    ]
    launch = {
        "name": "Stop in the shader",
        "type": "cppdbg",
        "request": "launch",
        "MIMode": "gdb",
        "cwd": "${workspaceFolder}",
        "program": "${workspaceFolder}/build/bin/${input:chapter}",
        "args": ["${input:scene}", "--debug-pixel", "${input:pixel}"],
        "setupCommands": setup,
        "preLaunchTask": "build the chapters",
    }
    task = {"label": "build the chapters", "type": "shell", "command": "./lab run", "problemMatcher": []}
    return {
        "launch.json": {"version": "0.2.0", "inputs": inputs, "configurations": [launch]},
        "tasks.json": {"version": "2.0.0", "tasks": [task]},
    }


def write_vscode(folder):
    folder.mkdir(exist_ok=True)
    for name, contents in vscode_files().items():
        file, text = folder / name, json.dumps(contents, indent=4) + "\n"
        if file.exists() and file.read_text(encoding="utf-8") != text:
            raise UserError(f"{file} is there already: move it away, or add to it what ./lab debug --vscode writes elsewhere")
        file.write_text(text, encoding="utf-8")
        print(file.relative_to(ROOT) if file.is_relative_to(ROOT) else file)


def main():
    options, chapter_options, extra = parse()
    if options.vscode:
        return write_vscode(ROOT / ".vscode")
    if options.chapter is None:
        raise UserError(f"which chapter? ./lab debug N, with N one of {', '.join(map(str, CHAPTERS))}")
    if options.chapter not in CHAPTERS:
        raise UserError(f"there is no chapter {options.chapter}: there are {', '.join(map(str, CHAPTERS))}")
    debugger = shutil.which("gdb") or shutil.which("lldb")
    if not debugger:
        raise UserError("there is no debugger: install gdb")
    program = str(program_file(CHAPTERS[options.chapter]))
    arguments = [*chapter_options, "--first-sample", str(options.sample), "--debug-pixel", options.pixel or "256,256"]
    sys.stdout.flush()
    command = command_for(debugger, program, arguments, extra, first_function(CHAPTERS[options.chapter]))
    os.execv(command[0], command)
