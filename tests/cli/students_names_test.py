"""Shaders with names of the engine, as students write them: a page renders what the backend `compute` does."""

import json
import shutil
import subprocess
import unittest

from program import BINARIES, ProgramTest  # first: it finds the others
import numpy as np
from book import live
from browser import CHROMIUM, Browser
from image_files import Exr
from project import CHAPTERS, text_of
from tools_path import PROJECT

STUDENTS = PROJECT / "tests/browser/students"
SCENE, SIZE, SAMPLES, LENGTH = "cornell_box", 16, 2, ["--max-path-length", 2]
MOST_DIFFERENT = 2  # pixels of 256: where rounding decides which triangle a ray meets


@unittest.skipUnless(CHROMIUM, "needs Chromium, which ./lab test installs")
class StudentsNamesTest(ProgramTest):
    def setUp(self):
        super().setUp()
        browser = self.enterContext(Browser())
        chapter = CHAPTERS[3]
        arrays, parameters, _, _ = live.dump(self.folder / "dump", chapter, SCENE, *LENGTH)
        scripts = ["sources.js", *live.SCRIPTS[:live.SCRIPTS.index("renderer.js") + 1], "film.js"]
        for name in scripts[1:-1]:
            shutil.copy(live.HERE / name, self.folder)
        shutil.copy(PROJECT / "tests/browser/film.js", self.folder)
        told = {"sources": live.shaders(), "scene": arrays, "words": parameters, "data": {}}
        (self.folder / "sources.js").write_text(f"var live = {json.dumps(told)};", encoding="utf-8")
        (self.folder / "page.html").write_text("<canvas></canvas>" + "".join(f'<script src="{name}"></script>' for name in scripts), encoding="utf-8")
        browser.visit((self.folder / "page.html").as_uri())
        self.chapter, self.browser = chapter, browser

    def on_page(self, file):
        helpers = {f"chapters/{self.chapter}/{helper.name}": text_of(helper) for helper in file.with_suffix("").glob("*.glsl")}
        texts = json.dumps({f"chapters/{self.chapter}/path_trace.glsl": text_of(file)} | helpers)
        return np.reshape(self.browser.evaluate(f"live.film('{self.chapter}', live.scene, live.words, {texts}, [{SIZE}, {SIZE}], {SAMPLES})"), (-1, 3))

    def in_program(self, file):
        folder = self.folder / file.stem
        shutil.copytree(file.with_suffix(""), folder) if file.with_suffix("").exists() else folder.mkdir()
        shutil.copy(file, folder / "path_trace.glsl")
        output = folder / "picture.exr"
        command = [BINARIES / self.chapter, SCENE, *LENGTH, "--width", SIZE, "--height", SIZE, "--samples", SAMPLES, "--backend", "compute", "--shader", f"path_trace.glsl={folder / 'path_trace.glsl'}",
                   "--headless", "--quiet", "--output", output]
        process = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        self.assertEqual(process.returncode, 0, process.stderr)
        return np.array(Exr(output).pixels()).reshape(3, -1).T

    def test_pictures_are_those_of_compute(self):
        files = sorted(STUDENTS.glob("*.glsl"))
        self.assertGreater(len(files), 6)
        for file in files:
            with self.subTest(shader=file.name):
                expected = self.in_program(file)
                self.assertGreater(expected.mean(), 0)
                different = (np.abs(self.on_page(file) - expected) > 1e-4 * (1 + np.abs(expected))).any(axis=1).sum()
                self.assertLessEqual(different, MOST_DIFFERENT)


if __name__ == "__main__":
    unittest.main()
