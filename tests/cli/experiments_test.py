"""The experiments of ./lab check, and what they are compared with."""


import json
import re
import struct
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import tools_path  # noqa: F401  (first: it finds the others)
from check import diagnosis, expected
from check.diagnosis import reason
from check.experiments import (
    Experiment,
    Point,
    Sight,
    experiment,
    experiment_files,
    experiments_of,
    faces_of,
    merged,
    write_scene,
)
from check.facts import DARK
from check.expected import expected_file, known_mistakes
from check.grading import OPTIONS, RUNS, first_seed
from project import chapter_named, course, read_json

from shown_facts import seen


class ExperimentsTest(unittest.TestCase):
    def test_each_chapter_of_the_course_has_about_a_dozen_and_each_is_described_once(self):
        files = experiment_files()
        self.assertEqual(list(files), course())
        names = [name for file in files.values() for name in file.get("experiments", {})]
        self.assertEqual(len(names), len(set(names)))
        for chapter in files:
            self.assertGreaterEqual(len(experiments_of(chapter)), 11)
            for one in experiments_of(chapter).values():
                self.assertLessEqual(set(one.when), set(experiments_of(chapter)), (chapter, one.name))
                self.assertTrue(one.subject and one.points and all(point.scene for point in one.points), (chapter, one.name))

    def test_a_chapter_uses_only_what_it_or_an_earlier_one_describes(self):
        """Otherwise it would be missing from a student's tree of the first chapters."""
        described = set()
        for chapter, file in experiment_files().items():
            described |= set(file.get("experiments", {}))
            self.assertLessEqual(set(file["uses"]), described, f"chapter {chapter}")

    def test_points_that_are_channels_of_one_colour_do_not_claim_all_colours(self):
        for chapter in experiment_files():
            for one in experiments_of(chapter).values():
                if all(point.channel is not None for point in one.points) and all(
                    point.scene == one.points[0].scene for point in one.points
                ):
                    self.assertEqual(one.varies, "the channel", f"{one.name}: a grey wall may be right")

    def test_points_differ_in_what_they_say(self):
        made = experiment(
            "x",
            {
                "subject": "s",
                "scene": {"lamp": {"size": 1, "emits": 2}, "plate": {"size": 3}},
                "options": "--a 1",
                "points": [{"at": "one"}, {"at": "two", "scene": {"lamp": {"size": 4}, "plate": None}, "options": "--b 2"}],
            },
            8,
        )
        self.assertEqual(
            [point.scene for point in made.points],
            [{"lamp": {"size": 1, "emits": 2}, "plate": {"size": 3}}, {"lamp": {"size": 4, "emits": 2}}],
        )
        self.assertEqual([point.options for point in made.points], ["--a 1", "--a 1 --b 2"])
        self.assertEqual(merged({"a": 1}, {"a": 2, "b": {"c": 3}}), {"a": 2, "b": {"c": 3}})

    def test_plates_face_where_they_say_and_boxes_outwards(self):
        def normal(face):
            a, b = ([q - p for p, q in zip(face[0], other)] for other in (face[1], face[2]))
            return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

        for direction in ([0, 1, 0], [1, 0, 0], [0, 0, -1], [0.6, 0.8, 0]):
            found = normal(faces_of({"centre": [1, 2, 3], "faces": direction, "size": [2, 1]})[0])
            for got, expected in zip(found, direction):
                self.assertAlmostEqual(got, 2 * expected)
        lamp = faces_of({"polar": 30, "azimuth": 180, "distance": 2, "size": 0.5})[0]
        centre = [sum(corner[i] for corner in lamp) / 4 for i in range(3)]
        self.assertAlmostEqual(centre[0], -1)
        self.assertLess(sum(c * n for c, n in zip(centre, normal(lamp))), 0, "towards the origin")
        for shape, sign in (({"box": [1, 2, 3], "turn": 20}, 1), ({"ball": 1}, -1)):
            for face in faces_of(shape):
                middle = [sum(corner[i] for corner in face) / len(face) for i in range(3)]
                self.assertGreater(sign * sum(c * n for c, n in zip(middle, normal(face))), 0, shape)

    def test_strips_and_corners_lie_where_they_say(self):
        def points(chapter, name):
            return [(point.at, point.scene) for point in experiments_of(int(chapter_named(chapter)[:2]))[name].points]

        for at, scene in points("lens", "lens_disc"):
            if "strip" in at:
                width, height = (max(corner[axis] for corner in faces_of(scene["lamp"])[0]) for axis in (0, 1))
                self.assertEqual(width > height, "horizontal" in at, at)
        for at, scene in points("next_event_estimation", "corners_of_a_lamp"):
            hidden = [sum(corner[axis] for corner in faces_of(scene["plate"])[0]) for axis in (0, 2)]
            self.assertEqual([hidden[0] > 0, hidden[1] > 0], ["left" in at, "behind" in at], at)

    def test_materials_are_rough_and_scenes_have_keys_only_where_they_say_so(self):
        plate = {"centre": [0, 0, 0], "faces": [0, 1, 0], "size": 1}
        said = {
            "plate": plate | {"rough": 0.4, "metal": 1},
            "pane": plate | {"glass": 1.5, "rough": 0.2},
            "multiple_scattering": True,
        }
        with tempfile.TemporaryDirectory() as folder:
            keys, materials = [], []
            for name, scene in (("rough", said), ("smooth", {"plate": plate})):
                keys.append(set(json.loads(write_scene(scene, Path(folder), name).read_text(encoding="utf-8"))))
                materials.append((Path(folder) / f"{name}.mtl").read_text(encoding="utf-8"))
        self.assertEqual(keys[0] - keys[1], {"multiple_scattering"})
        self.assertEqual(re.findall(r"P[mr] .*", materials[0]), ["Pr 0.4", "Pm 1", "Pr 0.2", "Pm 0"])
        self.assertNotRegex(materials[1], r"P[mr]|Ks")

    def test_a_scene_may_have_a_grid_of_its_own_densities(self):
        with tempfile.TemporaryDirectory() as folder:
            for density, name in (([0.5, 10], "smoky.vol"), ("smoke.vol", "smoke.vol")):
                file = write_scene({"fog": {"extinction": 1, "density": density}}, Path(folder), "smoky")
                grid = Path(json.loads(file.read_text(encoding="utf-8"))["fog"]["density"])
                self.assertEqual((grid.name, grid.read_bytes()[:4]), (name, b"VOL\3"))
            magic, _, x, y, z, channels, *_, first, second = struct.unpack("<4s5i6f2f", (Path(folder) / "smoky.vol").read_bytes())
            self.assertEqual((x, y, z, channels, first, second), (1, 1, 2, 1, 0.5, 10))

    def test_a_scene_may_have_a_light_probe_of_its_own_and_a_body_with_a_medium(self):
        medium = {"extinction": 1, "albedo": 0.5, "boundary": "open"}
        pieces = {"fog bank": {"box": [1, 1, 1], "medium": medium}, "lamp": {"centre": [0, 2, 0], "faces": [0, -1, 0], "size": 1}}
        with tempfile.TemporaryDirectory() as folder:
            file = write_scene(pieces | {"background": {"light_probe": [4, 0.5]}}, Path(folder), "foggy")
            scene = json.loads(file.read_text(encoding="utf-8"))
            header, _, pixels = Path(scene["background"]["light_probe"]).read_bytes().partition(b"+X 4\n")
            faces = [(Path(folder) / mesh["file"]).read_text(encoding="utf-8").count("f ") for mesh in scene["meshes"]]
        self.assertEqual([mesh.get("medium") for mesh in scene["meshes"]], [None, medium])
        self.assertEqual(faces, [1, 6])
        self.assertIn(b"-Y 2", header)
        self.assertEqual([128 * 2.0 ** (pixels[texel + 3] - 136) for texel in (0, 16)], [4, 0.5])

    def test_where_a_chapter_has_a_loop_over_samples_each_thread_takes_all_of_a_pixel(self):
        self.assertEqual(
            [chapter for chapter in course() if "--max-threads-per-pixel 1" in " ".join(OPTIONS[chapter])],
            [chapter for chapter in course() if chapter >= int(chapter_named("path_regeneration")[:2])],
        )


class ExpectedTest(unittest.TestCase):
    """What is recorded of the chapters' own shaders."""

    def known(self):
        return {chapter: read_json(expected_file(chapter)) for chapter in course() if expected_file(chapter).exists()}

    def test_all_experiments_are_known(self):
        self.assertTrue(self.known())
        for chapter, entry in self.known().items():
            self.assertEqual(
                list(entry["experiments"]), list(experiments_of(chapter)), f"chapter {chapter}: ./lab notebook learn"
            )

    def test_every_lit_point_is_bright_enough_to_be_judged(self):
        """Beside a much brighter one it counts as dark, where only light that should not be there is wrong."""
        dim = {
            (chapter, name)
            for chapter, known in self.known().items()
            for name, seen in known["experiments"].items()
            if any(0 < abs(mean) <= DARK * max(map(abs, seen["mean"])) for mean in seen["mean"])
        }
        self.assertEqual(dim, {(11, "frosted_ray")}, "whose lobe is dark beside the refracted ray")

    def test_levels_have_the_seeds_of_a_check_so_that_renders_are_compared_one_by_one(self):
        seeds = [str(first_seed(0) + run) for run in range(RUNS)]
        for chapter, entry in self.known().items():
            for scene, level in entry["levels"].items():
                self.assertEqual(list(level["rel_mse"]), seeds, (chapter, scene))

    def test_without_the_notebook_facts_have_no_names(self):
        facts = {"angle": seen([2.0] * 3)}
        with mock.patch.object(expected, "KNOWLEDGE", Path("/nowhere")):
            known = {"experiments": {}, "mistakes": known_mistakes(3)}
        with mock.patch.object(diagnosis, "next_step"):
            found = reason(facts, {}, known, False)
        self.assertEqual((found["mistakes"], found["fits"]), ([], False))
        self.assertRegex(found["facts"][0]["text"], "2.00 ± 0.01 times as bright")


def verdict(of_pictures, look_closer=None, **found):
    """The verdict if pictures have this one, and experiments find this."""
    result = {"verdict": of_pictures, "scenes": [{"invalid_samples": 0}]}
    result["diagnosis"] = {"wrong": [], "is_beyond_doubt": False, "too_noisy": None} | found
    with mock.patch.object(diagnosis, "look_closer", look_closer or (lambda *_: None)):
        diagnosis.decide(None, {}, result, [])
    return result["verdict"]


class DecidingExperiments(unittest.TestCase):
    def verdict_with_noise(self, factor, is_of_noise=True):
        known = {
            key: [values]
            for key, values in {"mean": 0.5, "error": 0.001, "noise": 0.01, "noise_error": 0.0001, "rays": 3.0}.items()
        }
        of = Experiment("kept", "light", "why", [Point({}, "x")], decides=True, is_of_noise=is_of_noise)
        noise = diagnosis.too_much_noise(of, [Sight(0.5, 0.001, 0.01 * factor, 0.0001, 3.0)], known)
        self.assertIn(noise, (0, factor))
        return verdict("correct", too_noisy=noise)

    def test_noise_counts_where_an_experiment_is_about_it(self):
        self.assertEqual([self.verdict_with_noise(factor) for factor in (1.4, 2.0)], ["correct", "noisy"])
        self.assertEqual(self.verdict_with_noise(2.0, is_of_noise=False), "correct")

    def test_a_bias_that_no_experiment_shows_takes_a_closer_look(self):
        def look_closer(submission, settings, result, pictures):  # noqa: ARG001
            result["verdict"] = seen_closer

        for seen_closer in ("biased", "noisy", "correct"):
            self.assertEqual(verdict("biased", look_closer), seen_closer)
            self.assertEqual(verdict("biased", look_closer, wrong=["angle"]), "biased")
            self.assertEqual(verdict("noisy", look_closer), "noisy")
        self.assertEqual(verdict("biased", look_closer, too_noisy=["light", 3.0]), "noisy")
        for of_pictures in ("correct", "expensive", "noisy"):  # noise may hide a bias from the pictures
            self.assertEqual(verdict(of_pictures, is_beyond_doubt=True, wrong=["angle"]), "biased")
            self.assertEqual(verdict(of_pictures, wrong=["angle"]), of_pictures)
