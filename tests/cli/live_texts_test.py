"""What readers write on the pages of the book: it is kept, shared by a link, and comes back after it was replaced."""

import json
import unittest

from live_pages_test import BLACK, ESTIMATOR, LivePages  # first: it finds the others
from course.mistakes import bugs_of


class LiveTexts(LivePages):
    def text(self):
        return self.frame(f"frame.editor.sources['{ESTIMATOR}']")


class LiveTextsTest(LiveTexts, unittest.TestCase):
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
        self.assertRegex(
            self.frame("frame.edits.textContent"),
            "^Changed by you: sample_hemisphere.glsl of chapter 2 .on its page, too.. “Original text” undoes it",
        )
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
        self.browser.evaluate(
            "Storage.prototype.setItem = () => { throw new Error('forbidden'); }; Storage.prototype.removeItem = Storage.prototype.setItem"
        )
        self.edit("vec3 radiance = vec3(0.0);", "vec3 radiance = vec3(0.5);")
        self.assertIn("keeps no text", self.frame("frame.note.textContent"))


class LiveTexts_all(LiveTexts, unittest.TestCase):
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

    def test_exercises_start_from_the_placeholder_and_bugs_are_planted(self):
        self.start(3)
        self.click("Start exercise 1")
        selected = "(({value, selectionStart, selectionEnd}) => value.slice(selectionStart, selectionEnd))(frame.editor.field)"
        self.assertIn("// TODO", self.frame(selected))
        for number in range(len(bugs_of(3))):
            self.frame(f"frame.plant(frame.about.bugs[{number}])")
            self.assertEqual(self.frame("frame.editor.edited.length"), 1, f"bug {number + 1}")
            self.assertNotIn("// TODO", self.frame("Object.values(frame.editor.texts).join()"))

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
