"""What the tests of ./lab check share."""


import json
from copy import deepcopy
from unittest import mock

from program import PROJECT  # first: it finds the tools
from check import command, diagnosis, grading
from course.mistakes import planted
from report import batch

SHADER = PROJECT / "chapters/03_next_event_estimation/path_trace.glsl"
TECHNIQUE = SHADER.with_name("direct_light.glsl")
FEW = (3, "--runs", 5, "--samples", 4)


class Checking:
    """The command in this process."""

    judged = {}  # results of judge(), shared by all tests

    def setUp(self):
        super().setUp()
        self.judge = mock.Mock(side_effect=self.judge_once)
        # One render at a time, so that the others need not compile its shader as well.
        for where, what, stand_in in (
            (command, "judge", self.judge),
            (command, "diagnose", self.diagnose_once),
            (batch, "JOBS", 1),
        ):
            patch = mock.patch.object(where, what, stand_in)
            patch.start()
            self.addCleanup(patch.stop)

    def judge_once(self, submission, settings, watch, is_enough):  # noqa: ARG002 (the next format may need all runs)
        """judge(), but renders a shader only once for all formats in which the command reports the same verdict."""
        key = (
            submission.file.read_bytes(),
            *grading.SCENES[submission.chapter][1],
            *(settings[name] for name in ("runs", "samples", "first_seed")),
        )
        if key not in self.judged:
            early = []
            self.judged[key] = (*grading.judge(submission, settings, watch=lambda cases: early.append(deepcopy(cases))), early)
        result, pictures, early = deepcopy(self.judged[key])
        for cases in early:
            watch(cases)
        return result | {"file": submission.name}, pictures

    def diagnose_once(self, submission, settings, is_correct):
        key = (submission.file.read_bytes(), is_correct, settings["first_seed"])
        if key not in self.judged:
            self.judged[key] = diagnosis.diagnose(submission, settings, is_correct)
        return deepcopy(self.judged[key])

    def check(self, *arguments):
        """Exit code, standard output and standard error of the command, run in this process."""
        return self.run_here(command.main, "--backend", "compute", *arguments)

    def check_few(self, *arguments):
        code, out, err = self.check(*FEW, "--json", *arguments)
        self.assertIn(code, (0, 1), err)
        return code, json.loads(out)

    def in_one_scene(self):
        """For tests whose subject shows just as well in the first scene alone."""
        return mock.patch.dict(grading.SCENES, {3: (4, ["check_room_2"])})

    def wrong(self):
        """A file with a mistake."""
        return self.write("mine.glsl", TECHNIQUE.read_text(encoding="utf-8").replace("/ (distance * distance)", "/ distance"))

    def planted(self, chapter, find, replace):
        """Name of a file with one of a chapter's own shaders, changed in one place."""
        return self.write("mine.glsl", planted(chapter, {"name": "mine", "find": find, "replace": replace}).text)
