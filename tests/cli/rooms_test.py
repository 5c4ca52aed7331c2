"""The rooms in common/README.md: no source includes a room above its own, and the picture shows all includes."""

import tempfile
import unittest
from pathlib import Path
from unittest import mock

from program import PROJECT  # first: it finds the tools
import includes
from docs import rooms

FILES = {
    "common/README.md": "| `tools/upper/` | |\n| `common/lower/` | |\n| `chapters/` | |\n",
    "common/lower/room.h": "",
    "tools/upper/program.cpp": '#include "lower/room.h"\n',
    "shaders/replaceable.json": "[]",
    "chapters/01_a/path_trace.glsl": "",
    "chapters/02_b/path_trace.glsl": '#include "../01_a/path_trace.glsl"\n',
}


class RoomsTest(unittest.TestCase):
    def found(self, changed, look=rooms.upward):
        """What is wrong in a small tree with these files."""
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name).resolve()
            for file, text in {**FILES, **changed}.items():
                (folder / file).parent.mkdir(parents=True, exist_ok=True)
                (folder / file).write_text(text, encoding="utf-8")
            with mock.patch.object(rooms, "ROOT", folder), mock.patch.object(includes, "ROOT", folder):
                return look()

    def test_nothing_includes_a_room_above_its_own(self):
        self.assertEqual(rooms.upward(), [])

    def test_what_goes_upwards_is_named(self):
        self.assertEqual(self.found({}), [])
        self.assertEqual(
            self.found({"common/lower/room.h": '#include "../../tools/upper/program.cpp"\n'}),
            ["common/lower/room.h includes tools/upper/program.cpp"],
        )
        self.assertEqual(
            self.found({"chapters/01_a/path_trace.glsl": '#include "../02_b/path_trace.glsl"\n'}),
            ["chapters/01_a/path_trace.glsl includes chapters/02_b/path_trace.glsl"],
        )

    def test_only_programs_include_the_annexes(self):
        self.assertEqual(rooms.into_the_annexes(), [])
        rows = "".join(
            f"| `{room}/` | |\n" for room in ("common/app", "tools/upper", "common/viewer", "common/native", "common/lower")
        )
        tree = {
            "common/README.md": rows,
            "common/viewer/viewer.h": "",
            "common/native/module.h": "",
            "common/app/run.cpp": '#include "viewer/viewer.h"\n#include "native/module.h"\n',
        }
        self.assertEqual(self.found(tree, rooms.into_the_annexes), [])
        for source, annex in (("common/viewer/a.cpp", "native/module.h"), ("tools/upper/a.cpp", "viewer/viewer.h")):
            self.assertEqual(
                self.found(tree | {source: f'#include "{annex}"\n'}, rooms.into_the_annexes),
                [f"{source} includes common/{annex}"],
            )

    def test_nothing_outside_uses_the_notebook(self):
        self.assertEqual(rooms.into_the_notebook(), [])
        notebook = {"notebook/measure/rates.h": "", "notebook/peers/report.py": ""}
        for file, text, name in (
            ("common/lower/room.h", '#include "measure/rates.h"\n', "measure/rates.h"),
            ("tests/cli/a_test.py", "from peers import report\n", "peers"),
            ("tools/upper/a.py", 'open("notebook/records/a.json")\n', "notebook/records/a.json"),
        ):
            with tempfile.TemporaryDirectory() as folder, mock.patch.object(rooms, "ROOT", Path(folder)):
                for path, content in {**FILES, **notebook, file: text}.items():
                    (Path(folder) / path).parent.mkdir(parents=True, exist_ok=True)
                    (Path(folder) / path).write_text(content, encoding="utf-8")
                self.assertEqual(rooms.into_the_notebook(), [f"{file} uses {name}"])

    def test_every_folder_is_a_room(self):
        listed = set(rooms.read_rooms())
        for parent in ("common", "tools"):
            for folder in (PROJECT / parent).iterdir():
                if any(path.suffix in rooms.SUFFIXES for path in folder.rglob("*")):
                    self.assertIn(f"{parent}/{folder.name}", listed)

    def test_the_picture_shows_what_is_included(self):
        self.assertTrue(rooms.picture() == rooms.DIAGRAM.read_text(encoding="utf-8"), "run `python3 tools rooms`")
