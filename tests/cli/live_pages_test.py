"""The book's live frames in headless Chromium: verdicts, errors at the reader's line, and what browsers forbid."""

import json
import re
import time
import unittest

from book_test import INSPECT, NARROW, WIDE, Site  # first: it finds the others
from browser import CHROMIUM, Browser
from project import CHAPTERS, course
from tools_path import PROJECT

FRAME = "document.querySelector('.live').frame"
ESTIMATOR = f"chapters/{CHAPTERS[3]}/path_trace.glsl"
# The pictures of a page have 128 instead of 256 pixels a row, since a CPU draws them. Chapter 12's has as few as its reference already.
SMALL = """for (const { pictures } of Object.values(live.chapters)) for (const { parameters } of pictures) {
    const place = new live.Layout(live.sources["shaders/interface.h"]).offsetOf("RenderParameters", "image_size");
    if (parameters[place] < 256) continue;
    parameters[place] /= 2;
    parameters[place + 1] /= 2;
}"""
PATIENCE = 240  # seconds
BLACK = "vec3 radiance = vec3(0.0);"  # of the estimator


@unittest.skipUnless(CHROMIUM, "needs Chromium, which ./lab test installs")
class LivePages(Site):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.browser = cls.enterClassContext(Browser())
        cls.browser.resize(WIDE)

    def frame(self, expression):
        return self.browser.evaluate(f"(frame => {expression})({FRAME})")

    def wait(self, condition, what):
        """Waits until the expression about `frame` is true."""
        end = time.monotonic() + PATIENCE
        while not self.frame(condition):
            self.assertLess(
                time.monotonic(),
                end,
                f"{what}: {self.frame('frame.verdict?.textContent')} {self.frame('frame.editor?.error.textContent')}",
            )
            time.sleep(0.1)

    def start(self, chapter, fragment="", before="", page=None):
        self.browser.visit("about:blank")
        page = self.site / (page or f"chapters/{CHAPTERS[chapter]}/index.html")
        self.browser.visit(page.as_uri() + fragment)
        self.browser.evaluate(
            f"{SMALL}; {before}; document.querySelector('.live').scrollIntoView(); document.querySelector('.live-start').click()"
        )
        self.wait("frame.editor && frame.verdict.textContent !== 'starting …'" if not before else "true", "start")

    def end_pictures_after(self, samples):
        self.frame(f"(live.Picture.MOST_SAMPLES = {samples}, frame.film = null, void frame.restart())")

    def click(self, name):
        self.frame(f"[...frame.root.querySelectorAll('button')].find(button => button.textContent === '{name}').click()")

    def mouse(self, kind, x, y):
        """Of the left button, at a place relative to the picture's size."""
        place = self.frame(
            f"(({{left, top, width, height}}) => ({{x: left + {x} * width, y: top + {y} * height}}))(frame.picture.root.getBoundingClientRect())"
        )
        self.browser.call("Input.dispatchMouseEvent", type=kind, button="left", buttons=1, clickCount=1, **place)

    def edit(self, old, new):
        """Edits the first file with that text as a reader does."""
        self.frame(
            f"""(() => {{ const {{ editor }} = frame;
            editor.open(editor.files.find(file => editor.texts[file].includes({json.dumps(old)})));
            const {{ field }} = editor;
            field.value = field.value.replace({json.dumps(old)}, {json.dumps(new)});
            field.dispatchEvent(new Event("input")); frame.picture.stop(); frame.film = frame.latest = null; }})()"""
        )

    def error(self):
        self.wait("frame.editor.error.textContent", "an error")
        return self.frame("frame.editor.error.firstChild.textContent")

    def assert_no_complaints(self):
        self.assertEqual(self.browser.complaints(), [])
        self.assertEqual([url for url in self.browser.loaded() if not re.match("file:|data:|about:|blob:", url)], [])

    def assert_agrees(self, chapter):
        self.start(chapter)
        self.wait("frame.latest?.verdict", "a verdict")
        self.assertRegex(self.frame("frame.latest.text"), "^agrees with the reference: a bias above [0-9.]+ % would show by now$")
        self.assert_no_complaints()

    def tearDown(self):
        self.browser.evaluate("location.protocol === 'file:' && localStorage.clear()")  # not before a first page


class LivePagesTest(LivePages, unittest.TestCase):
    def test_a_chapter_agrees_with_its_reference(self):
        self.assert_agrees(3)

    def test_a_mistake_is_biased(self):
        self.start(3)
        self.edit("throughput *= PI * get_brdf(s, omega);", "throughput *= 1.1 * PI * get_brdf(s, omega);")
        self.wait("frame.latest?.verdict && frame.editor.edited.length", "a verdict")
        self.assertRegex(self.frame("frame.latest.text"), "^biased: red .*% ±")
        self.assert_no_complaints()

    def test_errors_are_at_the_readers_line(self):
        text = (PROJECT / ESTIMATOR).read_text(encoding="utf-8")
        line = 1 + text[: text.index("vec3 throughput")].count("\n")
        self.start(3)
        for wrong, message in (
            ("vec3 throughput = vec3(1.0)", "syntax error"),
            ("vec3 throughput = 1;", "cannot convert|constructor|="),
            ("vec3 throughput = vec3(ω);", "ASCII"),
            ('#include "missing.glsl"', "cannot find the include file"),
        ):
            self.edit("vec3 throughput = vec3(1.0);", wrong)
            error = self.error()
            shift = 1 if message == "syntax error" else 0  # the compiler notices in the next line
            self.assertRegex(error, rf"^{re.escape(ESTIMATOR)}:({line}|{line + shift}): .*({message})")
            self.edit(wrong, "vec3 throughput = vec3(1.0);")
            self.wait("!frame.editor.error.textContent && frame.film", "the picture")

    def test_the_keyboard_stays_in_the_frame(self):
        self.start(3)
        self.assertTrue(self.frame("document.activeElement === frame.controls.scene"))
        self.frame("(frame.editor.tabs.lastChild.focus(), frame.editor.tabs.lastChild.click())")
        self.assertTrue(
            self.frame(
                "document.activeElement === frame.editor.tabs.lastChild && document.activeElement.getAttribute('aria-selected') === 'true'"
            )
        )

    def test_fits_a_phone(self):
        self.browser.resize(NARROW)
        try:
            self.start(3)
            self.wait("frame.latest?.verdict", "a verdict")
            self.assertEqual(self.browser.evaluate(INSPECT)["wide"], [])
            unnamed = "[...frame.root.querySelectorAll('button, select, input, textarea')].filter(e => !e.labels?.length && !e.ariaLabel && !e.textContent.trim()).length"
            self.assertEqual(self.frame(unnamed), 0)
        finally:
            self.browser.resize(WIDE)

    def test_pages_are_small(self):
        for chapter in course():
            folder = self.site / "live"
            about = json.loads(
                re.search(r"^live\.chapters = (.*);$", (folder / "sources.js").read_text(encoding="utf-8"), re.MULTILINE)[1]
            )[CHAPTERS[chapter]]
            scripts = sum(file.stat().st_size for file in folder.glob("*.*"))
            for picture in about["pictures"]:
                size = scripts + sum(
                    (folder / "data" / f"{picture[key]}.js").stat().st_size for key in ("scene", "reference") if key in picture
                )
                self.assertLess(
                    size,
                    600_000 if picture["name"].startswith("cornell_box") else 2_600_000,
                    f"chapter {chapter}, {picture['name']}",
                )

    def test_every_chapter_has_a_frame(self):
        for chapter in course():
            page = (self.site / f"chapters/{CHAPTERS[chapter]}/index.html").read_text(encoding="utf-8")
            self.assertIn(f'data-chapter="{CHAPTERS[chapter]}"', page, "a line <!-- live: SCENE --> in its README.md")


class LivePages_all(LivePages, unittest.TestCase):
    def test_the_gallery_starts_from_bugs(self):
        self.browser.visit("about:blank")
        self.browser.visit((self.site / "docs/bugs.html").as_uri())
        self.assertEqual(
            self.browser.evaluate("document.querySelectorAll('.live-start').length"),
            (PROJECT / "docs/bugs.md").read_text(encoding="utf-8").count("<!-- live: "),
        )
        self.browser.evaluate(
            f"{SMALL}; document.querySelector('.live').scrollIntoView(); document.querySelector('.live-start').click()"
        )
        self.wait("frame.latest?.verdict", "a verdict")
        self.assertRegex(self.frame("frame.latest.text"), "^biased: ")
        frames = "[...document.querySelectorAll('.live')].map(root => root.frame)"
        self.browser.evaluate(f"{frames}[1].root.querySelector('.live-start').click()")
        self.browser.evaluate(f"{frames}[1].root.scrollIntoView()")
        self.wait(f"{frames}[1].film", "the second bug")
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('canvas:not(.live-overlay)').length"), 1)
        self.assertIn("Restart goes on", self.frame("frame.verdict.textContent"))
        self.frame("(frame.root.scrollIntoView(), frame.film = null)")
        self.click("Restart")
        self.wait("frame.film", "the first bug again")
        self.assertEqual(self.browser.evaluate("Object.keys(localStorage).filter(key => key.startsWith('path tracing lab'))"), [])
        self.assert_no_complaints()

    def test_the_chapter_before_has_the_same_time(self):
        self.start(3)
        self.frame("(frame.controls.compared.checked = true, frame.restart(), 0)")
        self.wait(
            "/^After the same time, left chapter 3: .*; right chapter 2: /.test(frame.picture.caption.textContent)",
            "both chapters",
        )
        self.frame("frame.picture.line.focus()")
        times = self.frame("frame.picture.renderings.map(({ rendering }) => rendering.busy)")
        self.assertLess(max(times), 1.5 * min(times))
        for kind in ("keyDown", "keyUp"):
            self.browser.call("Input.dispatchKeyEvent", type=kind, key="ArrowRight", code="ArrowRight", windowsVirtualKeyCode=39)
        self.assertEqual(self.frame("frame.picture.line.value"), "51")
        self.assert_no_complaints()

    def test_the_view_of_surfaces_gives_no_verdict(self):
        self.start(3)
        self.frame("(frame.controls.view.value = 'NORMALS', frame.viewChanged())")
        self.wait("frame.film && frame.verdict.textContent.includes('surfaces')", "normals")
        self.frame("(frame.controls.view.value = 'picture', frame.viewChanged())")
        self.wait("frame.latest?.verdict && frame.verdict.textContent.startsWith('agrees')", "the picture again")

    def test_every_chapter_agrees_with_its_reference(self):
        for chapter in course():
            with self.subTest(chapter=chapter):
                self.assert_agrees(chapter)

    def test_the_page_that_tries_a_device(self):
        self.browser.visit((self.site / "docs/does_it_run_here.html").as_uri())
        self.browser.evaluate(f"{SMALL}; document.querySelector('.live-start').click()")
        report, end = "", time.monotonic() + 4 * PATIENCE
        while not report.rstrip().endswith("done"):
            self.assertLess(time.monotonic(), end, report)
            time.sleep(1)
            report = self.browser.evaluate("document.querySelector('.live textarea').value")
        self.assertEqual(report.count(": agrees with the reference"), 3, report)
        wrong = re.search(
            r"^furnace: (\d+) of 65536 pixels are wrong after 64 samples, 0 samples are no numbers$", report, re.MULTILINE
        )
        self.assertLess(int(wrong[1]), 20, report)  # missed hits: rays that pass between two triangles, as there is no `precise`
        self.assert_no_complaints()

    def check(self):
        self.frame("void frame.check()")
        self.wait("frame.results.textContent.includes('./lab check says')", "the check")
        self.assert_no_complaints()
        return self.frame("frame.results.textContent"), self.frame(
            "[...frame.results.querySelectorAll('li')].map(fact => fact.textContent)"
        )

    def test_the_check_passes_what_is_right(self):
        self.start(3)
        text, facts = self.check()
        self.assertIn("Correct on all scenes", text)
        self.assertEqual(facts, [])

    def test_the_check_says_what_only_experiments_show(self):
        self.start(3)
        self.edit("dot(y.normal, -omega)", "abs(dot(y.normal, -omega))")
        text, facts = self.check()
        self.assertIn("Biased: the scenes do not show it, but experiments do.", text)
        self.assertTrue(any("two lamps" in fact for fact in facts), facts)

    def test_the_check_says_what_is_wrong(self):
        self.start(3)
        self.edit("throughput *= PI * get_brdf(s, omega);", "throughput *= 2.0 * PI * get_brdf(s, omega);")
        text, facts = self.check()
        self.assertIn("Biased: the estimator is wrong on a scene.", text)
        self.assertTrue(
            any(
                re.match(
                    r"light in the glowing ball after two bounces: 2\.0\d ± 0\.0\d times as bright as it should be \(as by a factor 2\), whatever the albedo",
                    fact,
                )
                for fact in facts
            ),
            facts,
        )
        self.assertFalse(any(fact.startswith("light of a lamp after one bounce") for fact in facts), facts)
