"""Colours that are found back from a picture, on the page of chapter 17."""

import unittest

from live_pages_test import LivePages  # first: it finds the others
import numpy as np
from live_light_paths_test import TINY

TRUE = {2: [0.62, 0.12, 0.1], 3: [0.16, 0.46, 0.13]}  # red and green in cornell_box.mtl
CLOSE = 0.1  # relative, with 16 samples of a tiny picture


class LiveSolver_all(LivePages, unittest.TestCase):
    def solver(self, words):
        return self.frame(f"(solver => {words})(frame.solver)")

    def change(self, number, colour):
        """Chooses a colour as a reader does."""
        self.solver(
            f"(({{input}}) => (input.value = '{colour}', input.dispatchEvent(new Event('change'))))"
            f"(solver.materials.find(({{number}}) => number === {number}))"
        )

    def test_least_squares_find_changed_colours_back(self):
        self.start(17, before=TINY)
        self.wait("frame.film?.samples >= 2", "a picture")
        self.assertEqual(self.solver("solver.materials.map(({number}) => number)"), [1, 2, 3])  # not the lamp
        for number in TRUE:
            self.change(number, "#808080")
        self.wait("frame.film?.samples >= 2", "the picture with other colours")
        self.assertIn("colours have been changed", self.frame("frame.verdict.textContent"))
        self.solver("(solver.button.click(), null)")
        self.wait("frame.solver.steps.textContent.startsWith('Step 5')", "the last step")
        for number, colour in TRUE.items():
            found = self.solver(f"solver.materials[{number - 1}].albedo")
            self.assertLess(np.abs(np.log(np.divide(found, colour))).max(), CLOSE, (number, found))
        self.assertEqual(self.solver("solver.materials[0].albedo"), self.solver("solver.materials[0].truth"))
        self.frame("(void frame.check(), null)")
        self.assertFalse(self.solver("solver.isChanged"))

    def test_says_that_nothing_is_changed(self):
        self.start(17, before=TINY)
        self.wait("frame.film?.samples >= 2", "a picture")
        self.solver("(solver.button.click(), null)")
        self.assertIn("change one first", self.solver("solver.steps.textContent"))
        self.assert_no_complaints()
