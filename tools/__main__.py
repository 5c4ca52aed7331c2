"""The tools behind `lab`: python3 tools NAME ARGUMENTS.

common/README.md lists their rooms. Handouts leave out those for teachers: docs, course and package. project.py is what all share.
Tests import from here, never the other way.
"""
import sys
from importlib import import_module

import project

TOOLS = {  # name: module
    "book": "book.build",
    "bug": "course.bug",
    "chapters": "lesson.chapters",
    "check": "check.command",
    "debug": "debug.command",
    "diff": "lesson.diff",
    "figures": "docs.figures",
    "handout": "course.handout",
    "package": "package.make",
    "reference": "references.make",
    "report": "report.make",
    "rooms": "docs.rooms",
    "sample": "lesson.sample",
    "show": "lesson.show",
    "solve": "lesson.solve",
    "tables": "docs.tables",
    "windows": "package.windows_programs",
}


def main():
    name = sys.argv.pop(1) if len(sys.argv) > 1 else ""
    if name not in TOOLS:
        sys.exit(f"error: there is no tool '{name}': {', '.join(TOOLS)}")
    try:
        tool = import_module(TOOLS[name])
    except ModuleNotFoundError as error:
        project.ensure_packages()
        sys.exit(f"error: {error}: {project.INSTALL} installs what Python needs")
    except (project.UserError, OSError) as error:
        sys.exit(f"error: {error}")
    project.run_tool(tool)


if __name__ == "__main__":
    main()
