"""The tools behind `lab`: python3 tools NAME ARGUMENTS.

They stand in rooms: assets makes meshes, textures and scenes; references are images of another renderer, and how to read them;
check grades a shader; report measures speed against error; lesson shows what a chapter changes and what samplers do; book makes
a site of the pages. What only a teacher needs is in docs (tables and figures of the pages), course (handouts, and the
bugs of the catalogue of mistakes) and package (archives for machines without a compiler): handouts leave these out. project.py is
what all share. Tests import from here, never the other way.
"""
import sys
from importlib import import_module

import project

TOOLS = {  # name: module
    "assets": "assets.make", "benchmark": "docs.benchmark", "book": "book.build", "bug": "course.bug", "check": "check.command",
    "diff": "lesson.diff", "figures": "docs.figures", "handout": "course.handout", "package": "package.make", "peer": "references.peer",
    "reference": "references.make", "report": "report.make", "sample": "lesson.sample", "tables": "docs.tables",
    "windows": "package.windows_programs",
}


def main():
    name = sys.argv.pop(1) if len(sys.argv) > 1 else ""
    if name not in TOOLS:
        sys.exit(f"error: there is no tool '{name}': {', '.join(TOOLS)}")
    try:
        tool = import_module(TOOLS[name])
    except ModuleNotFoundError as error:
        sys.exit(f"error: {error}: {project.INSTALL} installs what Python needs")
    except project.UserError as error:
        sys.exit(f"error: {error}")
    project.run_tool(tool)


if __name__ == "__main__":
    main()
