"""Other renderers: what our scenes become, and how their pictures are counted. None of them has to be installed."""

import json
import sys
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import paths  # noqa: F401  (first of the others: it finds them)
from peers import compare, film, peer, renderers, simple_scenes
from project import ROOT, UserError
from references.images import Reference
from references.scenes import read_scene


def scene_named(name):
    return read_scene(ROOT / f"assets/scenes/{name}.json")


class Constant:
    """A renderer whose pictures show the number of their call, and which takes at most 100 samples at once."""

    largest = 100

    def __init__(self):
        self.calls = []

    def render(self, samples, seed):
        self.calls.append((samples, seed))
        return renderers.Frame(np.full((1, 2, 3), float(len(self.calls))), samples, 0.5, 1.0)


class SimpleScenesTest(unittest.TestCase):
    def test_what_no_peer_is_compared_on(self):
        for name, words in (
            ("microfacets", "microfacets of our formula.* and a background"),
            ("glossy", "a Phong lobe"),
            ("glass", "glass that absorbs"),
            ("milk", "media of meshes"),
            ("textured", "textures"),
            ("focus", "a lens"),
        ):
            with self.assertRaisesRegex(UserError, f"^A is not compared on scenes with.*{words}"):
                simple_scenes.refuse_what_peers_lack(scene_named(name), "A")
        for name in ("cornell_box", "heart_light", "clear_glass", "fog", "lamps"):
            simple_scenes.refuse_what_peers_lack(scene_named(name), "A")

    def test_corners(self):
        flat, smooth = [], []
        for surface in scene_named("clear_glass").surfaces:
            positions, triangles, normals = simple_scenes.corners(surface)
            self.assertEqual([positions[i] for i in triangles[-1]], surface.positions[-1].tolist())
            (flat if normals is None else smooth).append(surface)
            if normals is not None:
                self.assertEqual(len(normals), len(positions))
                np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
        self.assertTrue(flat and smooth)

    def test_the_camera_looks_at_its_target(self):
        camera = {"position": np.array([1.0, 2, 3]), "target": np.array([4.0, 2, -1]), "up": np.array([0.0, 2, 0])}
        matrix = simple_scenes.camera_matrix(camera)
        np.testing.assert_allclose(matrix @ [0, 0, -5, 1], [4, 2, -1, 1], atol=1e-12)
        np.testing.assert_allclose(matrix @ [0, 1, 0, 0], [0, 1, 0, 0], atol=1e-12)
        self.assertAlmostEqual(np.linalg.det(matrix), 1)  # not mirrored


class FilmTest(unittest.TestCase):
    def test_small_pictures_are_repeated(self):
        renderer, black = Constant(), Reference(np.zeros((1, 2, 3)), np.zeros((1, 2, 3)), {})
        rows = list(film.separate_rows(film.Film(renderer, black, 1), [16, 64]))
        self.assertEqual([samples for samples, _ in renderer.calls], [16] * 4 + [64])
        self.assertEqual(len({seed for _, seed in renderer.calls}), 5)
        self.assertEqual([row["mean"] for row in rows], [[2.5] * 3, [5.0] * 3])
        self.assertEqual([row["rel_mse"] for row in rows], [(1 + 4 + 9 + 16) / 4, 25.0])
        self.assertEqual([(row["samples"], row["seconds"], row["cpu_seconds"]) for row in rows], [(16, 0.5, 1.0), (64, 0.5, 1.0)])

    def test_without_a_reference_there_is_no_error(self):
        (row,) = film.separate_rows(film.Film(Constant(), None, 1), [16])
        self.assertEqual((row["rel_mse"], row["mean"]), (None, [2.5] * 3))

    def test_one_picture_grows(self):
        options = types.SimpleNamespace(samples=[250], sampler="stratified", time_limit=None)
        rows = film.growing_rows(film.Film(Constant(), None, 1), options)
        self.assertEqual([row["samples"] for row in rows], [84, 168, 252])
        self.assertAlmostEqual(rows[-1]["mean"][0], 2)
        self.assertEqual(rows[-1]["cpu_seconds"], 3.0)


class CommandTest(unittest.TestCase):
    def test_what_is_not_installed_is_named(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(renderers, "FOLDER", Path(folder)):
            with self.assertRaisesRegex(UserError, "cycles is not installed: ./lab notebook install_peer cycles"):
                compare.refuse_without_peers()

    def test_a_setting_of_another_renderer_is_refused(self):
        arguments = [
            "peer",
            "scene.json",
            "--variant=cycles",
            "--sampler=sobol",
            "--width=8",
            "--height=8",
            "--max-path-length=1",
            "--seed=1",
            "--samples=1",
        ]
        with mock.patch.object(sys, "argv", arguments), self.assertRaisesRegex(
            UserError, "cycles has no --sampler sobol: light_tree, no_light_tree"
        ):
            peer.main()

    def test_more_repetitions_are_added_to_a_record(self):
        seeds = []

        def run_case(case, _, arguments):
            seeds.append(int(arguments[-1]))
            rows = [{"samples": samples} for samples in (8, *compare.COUNTS)]
            return {"device": "a device", "rows": rows}

        with (
            tempfile.TemporaryDirectory() as folder,
            mock.patch.object(compare, "refuse_without_peers"),
            mock.patch.object(compare, "run_case", run_case),
        ):
            file = Path(folder) / "record.json"
            for repetitions in (2, 3):
                with mock.patch.object(sys, "argv", ["renderers", f"--record={file}", f"--repetitions={repetitions}"]):
                    compare.main()
            cases = json.loads(file.read_text())["cases"]
        self.assertEqual(seeds, [seed for seed in (1, 2, 3) for _ in cases])
        self.assertEqual({len(case["runs"]) for case in cases}, {3})
        ours = [[row["samples"] for row in case["runs"][0]["rows"]] for case in cases if not case["is_peer"]]
        self.assertEqual(ours, [counts for counts, *_ in compare.SCENES.values()])
