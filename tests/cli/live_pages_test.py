"""The book's live frames in headless Chromium: verdicts, errors at the reader's line, loops that do not end, and what browsers forbid."""

import json
import re
import time
import unittest

from book_test import INSPECT, NARROW, WIDE, Site  # first: it finds the others
from browser import CHROMIUM, Browser
from course.mistakes import bugs_of
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
PATIENCE = 25  # seconds
BLACK = "vec3 radiance = vec3(0.0);"  # of the estimator
# A device that writes at most so many textures of 128 bits at once.
WRITES_AT_MOST = """(() => {
    const most = %d, { prototype } = WebGL2RenderingContext, attach = prototype.framebufferTexture2D, bind = prototype.bindFramebuffer, { drawArrays } = prototype;
    const attached = new Map();
    let bound = null;
    prototype.bindFramebuffer = function(target, frame) { bound = frame; return bind.call(this, target, frame); };
    prototype.framebufferTexture2D = function(...all) { attached.set(bound, (attached.get(bound) ?? 0) + 1); return attach.apply(this, all); };
    prototype.checkFramebufferStatus = function() { return attached.get(bound) > most ? this.FRAMEBUFFER_UNSUPPORTED : this.FRAMEBUFFER_COMPLETE; };
    prototype.drawArrays = function(...all) { if (!(attached.get(bound) > most)) drawArrays.apply(this, all); };
})()"""


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
            self.assertLess(time.monotonic(), end, f"{what}: {self.frame('frame.verdict?.textContent')} {self.frame('frame.editor?.error.textContent')}")
            time.sleep(0.1)

    def start(self, chapter, fragment="", before=""):
        self.browser.visit("about:blank")
        self.browser.visit((self.site / f"chapters/{CHAPTERS[chapter]}/index.html").as_uri() + fragment)
        self.browser.evaluate(f"{SMALL}; {before}; document.querySelector('.live').scrollIntoView(); document.querySelector('.live-start').click()")
        self.wait("frame.editor && frame.verdict.textContent !== 'starting …'" if not before else "true", "start")

    def click(self, name):
        self.frame(f"[...frame.root.querySelectorAll('button')].find(button => button.textContent === '{name}').click()")

    def edit(self, old, new):
        """Edits the first file with that text as a reader does."""
        self.frame(f"""(() => {{ const {{ editor }} = frame;
            editor.open(editor.files.find(file => editor.texts[file].includes({json.dumps(old)})));
            const {{ field }} = editor;
            field.value = field.value.replace({json.dumps(old)}, {json.dumps(new)});
            field.dispatchEvent(new Event("input")); }})()""")

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


class LivePagesTest(LivePages, unittest.TestCase):
    def tearDown(self):
        self.browser.evaluate("localStorage.clear()")

    def test_chapters_agree_with_their_references(self):
        for chapter in (1, 3, 8, 10):
            with self.subTest(chapter=chapter):
                self.assert_agrees(chapter)

    def test_a_mistake_is_biased(self):
        self.start(3)
        self.edit("throughput *= PI * get_brdf(s, omega);", "throughput *= 1.1 * PI * get_brdf(s, omega);")
        self.wait("frame.latest?.verdict && frame.editor.edited.length", "a verdict")
        self.assertRegex(self.frame("frame.latest.text"), "^biased: red .*% ±")
        self.assert_no_complaints()

    def test_errors_are_at_the_readers_line(self):
        text = (PROJECT / ESTIMATOR).read_text(encoding="utf-8")
        line = 1 + text[:text.index("vec3 throughput")].count("\n")
        self.start(3)
        for wrong, message in (("vec3 throughput = vec3(1.0)", "syntax error"), ("vec3 throughput = 1;", "cannot convert|constructor|="),
                               ("vec3 throughput = vec3(ω);", "ASCII"), ('#include "missing.glsl"', "cannot find the include file")):
            self.edit("vec3 throughput = vec3(1.0);", wrong)
            error = self.error()
            shift = 1 if message == "syntax error" else 0  # the compiler notices in the next line
            self.assertRegex(error, rf"^{re.escape(ESTIMATOR)}:({line}|{line + shift}): .*({message})")
            self.edit(wrong, "vec3 throughput = vec3(1.0);")
            self.wait("!frame.editor.error.textContent && frame.film", "the picture")

    def test_a_loop_that_does_not_end(self):
        """Nor does the next one in the same page, once the reader has mended the first."""
        right = "vec3 throughput = vec3(1.0);"
        self.start(3)
        for loop in ("while (true) { radiance.r += 0.0; }", "for (;;) radiance.r += 0.0;", "do { radiance.r += 0.0; } while (true);",
                     "if (seed.x % 4096u == 0u) while (true) { radiance.r += 0.0; }"):
            self.edit(right, f"{right} {loop}")
            self.assertRegex(self.error(), r"path_trace\.glsl:\d+: this loop does not end")
            self.assertFalse(self.frame("frame.renderer.gl.isContextLost()"))
            self.edit(f"{right} {loop}", right)
            self.wait("!frame.editor.error.textContent && frame.film", "the picture")

    def text(self):
        return self.frame(f"frame.editor.sources['{ESTIMATOR}']")

    def test_texts_are_kept_and_shared(self):
        self.start(3)
        self.edit(BLACK, "vec3 radiance = vec3(0.5);")
        link = self.frame("frame.editor.link()")
        self.start(3)
        self.assertIn("vec3(0.5)", self.text())
        self.click("Original text")
        self.start(3)
        self.assertNotIn("vec3(0.5)", self.text())
        self.start(3, "#" + link.partition("#")[2])
        self.assertIn("vec3(0.5)", self.text())
        self.start(3, "#live=damaged")
        self.assertIn("damaged", self.frame("frame.note.textContent"))
        self.assertIn("vec3(0.5)", self.text())

    def test_a_link_is_copied_and_read_once(self):
        self.start(3)
        self.edit(BLACK, "vec3 radiance = vec3(0.5);")
        link = self.frame("frame.editor.link()")
        self.browser.evaluate("navigator.clipboard.writeText = text => { window.copied = text; return Promise.resolve(); }")
        self.frame("frame.copyLink()")
        self.assertEqual(self.browser.evaluate("[window.copied, location.hash]"), [link, ""])
        self.browser.evaluate("navigator.clipboard.writeText = () => Promise.reject(new Error('no'))")
        self.frame("frame.copyLink()")
        self.assertEqual(self.frame("[frame.note.querySelector('input').value, location.hash]"), [link, ""])
        self.edit("vec3(0.5)", "vec3(0.25)")
        self.start(3, "#" + link.partition("#")[2])
        self.assertIn("vec3(0.5)", self.text())
        self.assertEqual(self.browser.evaluate("location.hash"), "")
        self.assertIn("Bring my text back", self.frame("frame.note.textContent"))
        self.edit("vec3(0.5)", "vec3(0.125)")
        self.start(3)
        self.assertIn("vec3(0.125)", self.text())
        self.click("Bring my text back")
        self.assertIn("vec3(0.25)", self.text())

    def test_what_is_replaced_comes_back(self):
        self.start(3)
        self.assertTrue(self.frame("frame.editor.back.hidden"))
        self.edit(BLACK, "vec3 radiance = vec3(0.5);")
        self.click("Start exercise 1")
        self.frame("frame.plant(frame.about.bugs[0])")
        self.frame("frame.plant(frame.about.bugs[1])")
        self.frame("frame.plant(undefined)")
        self.assertIn("// TODO", self.frame("Object.values(frame.editor.texts).join()"))
        self.click("Original text")
        self.start(3)
        self.assertEqual(self.frame("frame.editor.edited"), [])
        self.click("Bring my text back")
        self.assertIn("vec3(0.5)", self.text())
        self.edit("vec3(0.5)", "vec3(0.25)")
        self.click("Original text")
        self.edit(BLACK, "vec3 radiance = vec3(1.0);")
        for colour in ("0.25", "1.0", "0.25"):
            self.click("Bring my text back")
            self.assertIn(f"vec3 radiance = vec3({colour})", self.text())

    def test_undo_brings_a_replaced_text_back(self):
        self.start(3)
        self.edit(BLACK, "vec3 radiance = vec3(0.5);")
        self.click("Original text")
        self.assertIn(BLACK, self.text())
        self.frame("frame.editor.field.focus()")
        self.browser.evaluate("document.execCommand('undo')")
        self.assertIn("vec3(0.5)", self.text())

    def test_a_note_names_what_was_changed_on_another_page(self):
        self.start(2)
        self.click("Start exercise 1")
        self.start(3)
        self.assertRegex(self.frame("frame.edits.textContent"), "^Changed by you: sample_hemisphere.glsl of chapter 2, which that chapter's page has, too. “Original text” undoes it")
        self.assertFalse(self.frame("frame.edits.hidden"))
        self.click("Original text")
        self.assertTrue(self.frame("frame.edits.hidden"))

    def test_texts_of_any_kind(self):
        self.start(3)
        self.frame("frame.editor.edit('\\uFEFF' + frame.editor.field.value.replaceAll('\\n', '\\r\\n'))")
        self.wait("frame.film && frame.editor.edited.length", "a picture of a text from Windows")
        self.frame("frame.editor.edit('x'.repeat(1000000))")
        self.assertIn("longer than any shader", self.error())

    def test_another_tab_that_changes_the_text_and_forbidden_storage(self):
        self.start(3)
        key = f"path tracing lab: {ESTIMATOR}"
        self.browser.evaluate(f"dispatchEvent(new StorageEvent('storage', {{ key: {json.dumps(key)} }}))")
        self.assertIn("Another tab", self.frame("frame.note.textContent"))
        self.browser.evaluate("Storage.prototype.setItem = () => { throw new Error('forbidden'); }; Storage.prototype.removeItem = Storage.prototype.setItem")
        self.edit("vec3 radiance = vec3(0.0);", "vec3 radiance = vec3(0.5);")
        self.assertIn("keeps no text", self.frame("frame.note.textContent"))

    def lose(self, losses=0, restores=True):
        """Takes the GPU away, as if that had happened so many times without a picture between."""
        self.frame(f"(frame.losses = {losses}, (window.loss ??= frame.renderer.gl.getExtension('WEBGL_lose_context')).loseContext())")
        self.wait("frame.renderer.gl.isContextLost() && !frame.renderings.length", "the loss")
        self.frame("(frame.film = null, 0)")
        if restores:
            self.frame("window.loss.restoreContext()")

    def test_a_lost_context_starts_again(self):
        self.start(3)
        for _ in range(3):
            self.wait("frame.film?.samples >= 16", "a picture")
            self.lose()
        self.wait("frame.film", "a new picture")
        self.lose(losses=1)
        self.wait("frame.verdict.textContent.includes('away again before')", "the message")
        self.click("Restart")
        self.wait("frame.film?.samples >= 16", "a picture")
        self.lose(restores=False)
        self.click("Restart")
        self.wait("frame.verdict.textContent.includes('has taken the GPU away: reload')", "the message")

    def test_devices_that_write_less_at_once(self):
        for most in (2, 1):
            self.start(3, before=WRITES_AT_MOST % most)
            self.wait("frame.latest?.verdict", "a verdict")
            self.assertRegex(self.frame("frame.latest.text"), "^agrees")
            self.assertGreater(self.frame("frame.film.rays"), 0)
            self.assert_no_complaints()
        self.start(3, before=WRITES_AT_MOST % 0)
        self.wait("frame.verdict?.textContent.includes('cannot store the sums')", "the message")

    def test_a_device_that_draws_nothing(self):
        self.start(3, before="WebGL2RenderingContext.prototype.drawArrays = () => {}")
        self.wait("frame.verdict?.textContent.includes('nothing is drawn')", "the message")

    def test_a_shader_without_rays_has_no_verdict(self):
        self.start(3)
        self.edit(BLACK, "vec3 radiance = vec3(0.5); if (radiance.r > 0.0) return radiance;")
        self.wait("frame.film?.samples >= 32 && frame.editor.edited.length", "a picture")
        self.assertEqual(self.frame("frame.verdict.textContent"), "no verdict: the shader traces no ray")
        self.frame("void frame.check()")
        self.wait("frame.verdict.textContent.includes('nothing to check')", "the message")

    def test_a_long_loop(self):
        self.start(3)
        self.edit(BLACK, BLACK + " for (int i = 0; i < 20000; ++i) radiance.r += 1e-20;")
        self.wait("frame.film && frame.editor.edited.length", "a picture")
        self.assertEqual(self.frame("frame.editor.error.textContent"), "")

    def test_a_pause(self):
        self.start(3)
        self.wait("frame.film", "a picture")
        self.click("Pause")
        self.edit(BLACK, "vec3 radiance = vec3(0.5);")
        self.assertIn("press Go on", self.frame("frame.note.textContent"))
        self.wait("frame.numbers.textContent.startsWith('paused')", "a paused picture")
        self.click("Go on")
        self.wait("frame.film", "a picture")
        self.edit("vec3(0.5);", "vec3(0.5)")
        self.error()
        self.assertEqual(self.frame("frame.numbers.textContent"), "")

    def test_a_frame_out_of_view_pauses(self):
        self.start(3)
        self.wait("frame.film", "a picture")
        self.frame("(frame.root.style.marginTop = '5000px', scrollTo(0, 0))")
        self.wait("!frame.isVisible", "the frame to be out of view")
        samples = self.frame("frame.renderings[0].rendering.samples")
        time.sleep(2)
        self.assertLessEqual(self.frame("frame.renderings[0].rendering.samples"), 2 * samples)
        samples = self.frame("frame.renderings[0].rendering.samples")
        time.sleep(2)
        self.assertEqual(self.frame("frame.renderings[0].rendering.samples"), samples)
        self.frame("frame.root.scrollIntoView()")
        self.wait(f"frame.renderings[0].rendering.samples > {samples}", "more samples")

    def test_the_keyboard_stays_in_the_frame(self):
        self.start(3)
        self.assertTrue(self.frame("document.activeElement === frame.scene"))
        self.frame("(frame.editor.tabs.lastChild.focus(), frame.editor.tabs.lastChild.click())")
        self.assertTrue(self.frame("document.activeElement === frame.editor.tabs.lastChild && document.activeElement.getAttribute('aria-selected') === 'true'"))

    def test_without_webgl(self):
        self.start(3, before="HTMLCanvasElement.prototype.getContext = () => null")
        self.wait("frame.verdict?.textContent.includes('no WebGL 2')", "the message")
        for name in ("Restart", "Check"):
            self.click(name)
        self.assert_no_complaints()

    def test_exercises_start_from_the_placeholder_and_bugs_are_planted(self):
        self.start(3)
        self.click("Start exercise 1")
        self.assertIn("// TODO", self.frame("frame.editor.field.value"))
        for number in range(len(bugs_of(3))):
            self.frame(f"frame.plant(frame.about.bugs[{number}])")
            self.assertEqual(self.frame("frame.editor.edited.length"), 1, f"bug {number + 1}")
            self.assertNotIn("// TODO", self.frame("Object.values(frame.editor.texts).join()"))

    def test_the_gallery_starts_from_bugs(self):
        self.browser.visit("about:blank")
        self.browser.visit((self.site / "docs/bugs.html").as_uri())
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('.live-start').length"), (PROJECT / "docs/bugs.md").read_text(encoding="utf-8").count("<!-- live: "))
        self.browser.evaluate(f"{SMALL}; document.querySelector('.live').scrollIntoView(); document.querySelector('.live-start').click()")
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
        self.frame("(frame.compared.checked = true, frame.restart(), 0)")
        self.wait("/^After the same time, left chapter 3: .*; right chapter 2: /.test(frame.caption.textContent)", "both chapters")
        self.frame("frame.line.focus()")
        times = self.frame("frame.renderings.map(({ rendering }) => rendering.busy)")
        self.assertLess(max(times), 1.5 * min(times))
        for kind in ("keyDown", "keyUp"):
            self.browser.call("Input.dispatchKeyEvent", type=kind, key="ArrowRight", code="ArrowRight", windowsVirtualKeyCode=39)
        self.assertEqual(self.frame("frame.line.value"), "51")
        self.assert_no_complaints()

    def test_a_hidden_tab_pauses(self):
        self.start(3, before="Object.defineProperty(document, 'hidden', { get: () => window.isHidden, configurable: true })")
        self.wait("frame.film", "a picture")
        self.browser.evaluate("window.isHidden = true")
        time.sleep(1)
        samples = self.frame("frame.renderings[0].rendering.samples")
        time.sleep(2)
        self.assertEqual(self.frame("frame.renderings[0].rendering.samples"), samples)
        self.browser.evaluate("window.isHidden = false")
        self.wait(f"frame.renderings[0].rendering.samples > {samples}", "more samples")

    def test_the_view_of_surfaces_gives_no_verdict(self):
        self.start(3)
        self.frame("(frame.view.value = 'NORMALS', frame.viewChanged())")
        self.wait("frame.film && frame.verdict.textContent.includes('surfaces')", "normals")
        self.frame("(frame.view.value = 'picture', frame.viewChanged())")
        self.wait("frame.latest?.verdict && frame.verdict.textContent.startsWith('agrees')", "the picture again")

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
            about = json.loads(re.search(r"^live\.chapters = (.*);$", (folder / "sources.js").read_text(encoding="utf-8"), re.MULTILINE)[1])[CHAPTERS[chapter]]
            scripts = sum(file.stat().st_size for file in folder.glob("*.*"))
            for picture in about["pictures"]:
                size = scripts + sum((folder / "data" / f"{picture[key]}.js").stat().st_size for key in ("scene", "reference"))
                self.assertLess(size, 600_000 if picture["name"].startswith("cornell_box") else 2_500_000, f"chapter {chapter}, {picture['name']}")

    def test_every_chapter_has_a_frame(self):
        for chapter in course():
            page = (self.site / f"chapters/{CHAPTERS[chapter]}/index.html").read_text(encoding="utf-8")
            self.assertIn(f'data-chapter="{CHAPTERS[chapter]}"', page, "a line <!-- live: SCENE --> in its README.md")


class LivePages_all(LivePages, unittest.TestCase):
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
        wrong = re.search(r"^furnace: (\d+) of 65536 pixels are wrong after 64 samples, 0 samples are no numbers$", report, re.MULTILINE)
        self.assertLess(int(wrong[1]), 20, report)  # missed hits: rays that pass between two triangles, as there is no `precise`
        self.assert_no_complaints()

    def check(self):
        self.frame("void frame.check()")
        self.wait("frame.results.textContent.includes('./lab check says')", "the check")
        self.assert_no_complaints()
        return self.frame("frame.results.textContent"), self.frame("[...frame.results.querySelectorAll('li')].map(fact => fact.textContent)")

    def test_the_check_passes_what_is_right(self):
        self.start(3)
        text, facts = self.check()
        self.assertIn("Correct on all scenes", text)
        self.assertEqual(facts, [])

    def test_the_check_says_what_is_wrong(self):
        self.start(3)
        self.edit("throughput *= PI * get_brdf(s, omega);", "throughput *= 2.0 * PI * get_brdf(s, omega);")
        text, facts = self.check()
        self.assertIn("Biased: the estimator is wrong on a scene.", text)
        self.assertTrue(any(re.match(r"light in the glowing ball after two bounces: 2\.0\d ± 0\.0\d times as bright as it should be \(as by a factor 2\), whatever the albedo", fact)
                            for fact in facts), facts)
        self.assertFalse(any(fact.startswith("light of a lamp after one bounce") for fact in facts), facts)


if __name__ == "__main__":
    unittest.main()
