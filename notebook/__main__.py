"""How the course is measured and proved: python3 notebook QUESTION ARGUMENTS, or ./lab notebook, which also builds what a question needs.

README.md lists the questions. The notebook imports the course's tools and starts its programs; nothing of the course imports it.
"""
import sys
import unittest
from importlib import import_module
from pathlib import Path

NOTEBOOK = Path(__file__).resolve().parent
sys.path += [str(NOTEBOOK.parent / folder) for folder in ("tools", "tests")]
import project  # noqa: E402  (found by the line above)

QUESTIONS = {  # name: module
    "ages": "tables.ages",
    "assets": "makers.make",
    "confusion": "learning.confusion",
    "export": "tables.export",
    "false_alarms": "measure.false_alarms",
    "figures": "tables.figures",
    "filters": "measure.filters",
    "hard_cases": "measure.hard_cases",
    "install_peer": "peers.install_peer",
    "large_picture": "measure.large_picture",
    "learn": "learning.learn",
    "lens_points": "measure.lens_points",
    "light_choices": "measure.light_choices",
    "derivatives": "measure.derivatives",
    "light_paths": "measure.light_paths",
    "media_strategies": "measure.media_strategies",
    "mistakes": "mistakes.cpp_mistake",
    "mutations": "mistakes.mutations",
    "native_speed": "measure.native_speed",
    "network": "measure.network",
    "peer": "peers.peer",
    "renderers": "peers.compare",
    "report": "peers.report",
    "sizes": "tables.sizes",
    "submissions": "learning.submissions",
    "variants": "learning.verify_variants",
    "waits": "measure.waits",
}


def main():
    name = sys.argv.pop(1) if len(sys.argv) > 1 else ""
    if name == "test":
        project.ensure_packages()
        unittest.main(
            None, argv=["./lab notebook test", "discover", "-s", str(NOTEBOOK / "tests"), "-p", "*_test.py", *sys.argv[1:]]
        )
    if name not in QUESTIONS:
        programs = sorted(
            file.stem for file in (NOTEBOOK / "measure").glob("*.cpp") if "int main(" in file.read_text(encoding="utf-8")
        )
        sys.exit(f"error: the notebook has no '{name}': {', '.join(['test', *QUESTIONS, *programs])}; see notebook/README.md")
    if name != "peer":  # which needs the user's own packages
        project.ensure_packages()
    try:
        tool = import_module(QUESTIONS[name])
    except (project.UserError, OSError) as error:
        sys.exit(f"error: {error}")
    project.run_tool(tool)


if __name__ == "__main__":
    main()
