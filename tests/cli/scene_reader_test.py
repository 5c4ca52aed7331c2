"""The Python reader that passes scenes to other renderers: it draws what models from elsewhere lack as the chapters do."""

import contextlib
import copy
import importlib
import io
import itertools
import json
import re
import sys
from unittest import mock

from program import PROJECT, QUAD_MTL, QUAD_OBJ, ProgramTest  # first: it finds the tools
import numpy as np  # only now: the tests have chosen a Python that has it
from project import UserError
from references.scenes import read_scene


class SceneReaderTest(ProgramTest):
    def read(self, obj):
        """Surfaces of a mesh, and messages about it."""
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            surfaces = read_scene(self.write("model.obj", obj)).surfaces
        return surfaces, said.getvalue()

    def test_what_has_no_material_is_grey(self):
        for old, new, missing in (("quad.mtl", "nowhere.mtl", "nowhere.mtl"), ("usemtl white", "usemtl pink", "pink")):
            with self.subTest(missing=missing):
                (surface,), said = self.read(QUAD_OBJ.replace(old, new))
                self.assertEqual(surface.material.diffuse_albedo.tolist(), [0.5] * 3)
                self.assertRegex(said, rf"\Anote: [^\n]*model\.obj:\d: there is no [^\n]*'{missing}'[^\n]*grey\n\Z")

    def test_names_with_spaces_around_them_are_found(self):
        self.write("quad.mtl", "newmtl  white \t\nKd 0.25 0.25 0.25\n")
        (surface,), said = self.read(QUAD_OBJ.replace("usemtl white", "usemtl   white  "))
        self.assertEqual((surface.material.diffuse_albedo.tolist(), said), ([0.25] * 3, ""))

    def test_a_material_file_that_is_named_twice_is_read_once(self):
        """As in the chapters: their hash of a scene covers everything they read."""
        model = self.write("model.obj", "mtllib quad.mtl\n" + QUAD_OBJ)
        value = 0xCBF29CE484222325
        for byte in model.read_bytes() + (self.folder / "quad.mtl").read_bytes():
            value = (value ^ byte) * 0x100000001B3 % 2**64
        self.assertEqual(read_scene(model).hash, f"{value:x}")

    def test_one_number_stands_for_three_and_halos_have_no_effect(self):
        self.write("quad.mtl", "newmtl white\nKd 0.25\nd -halo 0.5\nNi 1.5\nTf 0.5\n")
        (surface,), _ = self.read(QUAD_OBJ)
        self.assertEqual(surface.material.diffuse_albedo.tolist(), [0.25] * 3)
        self.assertEqual(surface.material.absorption.round(6).tolist(), [0.693147] * 3)

    def test_other_materials_than_those_of_the_mesh(self):
        """By name, or a single one for all of it."""
        self.write("model.obj", QUAD_OBJ)
        for mtl, diffuse in (
            ("newmtl red\nKd 0.5 0 0\n", [0.5, 0, 0]),
            ("newmtl red\nnewmtl white\nKd 0.25 0.25 0\n", [0.25, 0.25, 0]),
        ):
            self.write("more/other.mtl", mtl)
            scene = self.write("scene.json", json.dumps({"meshes": [{"file": "model.obj", "materials": "more/other.mtl"}]}))
            (surface,) = read_scene(scene).surfaces
            self.assertEqual(surface.material.diffuse_albedo.tolist(), diffuse)

    def test_a_reference_does_not_replace_the_probe_that_lights_it(self):
        self.write("quad.obj", QUAD_OBJ)
        probe = self.write("sky.exr", "kept")
        scene = self.write("scene.json", json.dumps({"meshes": [{"file": "quad.obj"}], "background": {"light_probe": "sky.exr"}}))
        with self.assertRaisesRegex(UserError, "sky.exr: would replace the scene's light probe"):
            with mock.patch.dict(sys.modules, {"references.mitsuba_scene": mock.MagicMock()}):
                importlib.import_module("references.make").make_reference(scene, probe, *[None] * 3, 4, 1)
        self.assertEqual(probe.read_text(), "kept")


def box(centre, size, mtl="none.mtl", faces="1243 5786 1562 3487 1375 2684"):
    """A closed box; `size` is half its edge."""
    corners = itertools.product((-1, 1), repeat=3)
    lines = ["v " + " ".join(str(c + s * size) for c, s in zip(centre, corner)) for corner in corners]
    return "\n".join([f"mtllib {mtl}", *lines, "usemtl a", *("f " + " ".join(face) for face in faces.split())]) + "\n"


# What the chapters read: for each key of a scene a path to it and another value, for each keyword of a material the lines before
# it and its own.
SCENE = {
    "description": "one",
    "meshes": [{"file": "quad.obj", "rotation": {"axis": [0, 1, 0], "degrees": 30}}],
    "camera": {"position": [0, 0, 3], "target": [0, 0, 0]},
    "background": {"radiance": [1, 1, 1]},
}
FOG = {"extinction": 1, "albedo": 1}
GRID = {**FOG, "density": "quad.obj", "box": [[0, 0, 0], [1, 1, 1]]}  # of which only the name and the bytes are read
PROBE = {"light_probe": "quad.obj", "intensity": 2}  # of which only the name and the bytes are read
KEYS = {
    "description": ("description", "two"),
    "meshes": ("meshes", 2 * SCENE["meshes"]),
    "camera": ("camera", None),
    "background": ("background", {"radiance": 0.5}),
    "specular": ("specular", True),
    "multiple_scattering": ("multiple_scattering", True),
    "width": ("width", 300),
    "height": ("height", 300),
    "samples": ("samples", 3),
    "max_path_length": ("max_path_length", 3),
    "file": ("meshes/0/file", "other.obj"),
    "materials": ("meshes/0/materials", "other.mtl"),
    "scale": ("meshes/0/scale", 2),
    "rotation": ("meshes/0/rotation", {"axis": [1, 0, 0], "degrees": 30}),
    "translation": ("meshes/0/translation", [1, 0, 0]),
    "axis": ("meshes/0/rotation/axis", [1, 0, 0]),
    "degrees": ("meshes/0/rotation/degrees", 40),
    "position": ("camera/position", [0, 1, 3]),
    "target": ("camera/target", [0, 1, 0]),
    "up": ("camera/up", [1, 0, 0]),
    "vertical_fov": ("camera/vertical_fov", 50),
    "fog": ("fog", FOG),
    "extinction": ("fog", {**FOG, "extinction": 2}),
    "albedo": ("fog", {**FOG, "albedo": 0.5}),
    "anisotropy": ("fog", {**FOG, "anisotropy": 0.5}),
    "medium": ("meshes/0/medium", FOG),
    "boundary": ("meshes/0/medium", {**FOG, "boundary": "open"}),
    "density": ("fog", {**GRID, "density": "other.obj"}),
    "box": ("fog", {**GRID, "box": [[0, 0, 0], [1, 2, 1]]}),
    "aperture_diameter": ("camera/aperture_diameter", 0.1),
    "focus_distance": ("camera/focus_distance", 2),
    "radiance": ("background/radiance", 0.5),
    "light_probe": ("background", PROBE),
    "intensity": ("background", {**PROBE, "intensity": 3}),
    "rotation_degrees": ("background", {**PROBE, "rotation_degrees": 90}),
}
KEYWORDS = {
    "newmtl": ("", "newmtl another"),
    "map_Kd": ("", "map_Kd quad.obj"),
    "Kd": ("", "Kd 0.2 0.2 0.2"),
    "Ke": ("", "Ke 1 1 1"),
    "Ks": ("", "Ks 0.1 0.1 0.1"),
    "Ns": ("Ks 0.1 0.1 0.1", "Ns 5"),
    "d": ("Ni 1.5", "d 0.5"),
    "Tr": ("Ni 1.5", "Tr 0.5"),
    "Ni": ("d 0.5", "Ni 1.3"),
    "Tf": ("d 0.5", "Tf 0.5 0.5 0.5"),
    "Kt": ("d 0.5", "Kt 0.5 0.5 0.5"),
    "Pr": ("", "Pr 0.3"),
    "Pm": ("Pr 0.3", "Pm 1"),
    "Ka": ("", "Ka 1 1 1"),
    "illum": ("", "illum 4"),
}
WITHOUT_EFFECT = {"description", "samples", "Ka", "illum"}


def plain(value):
    """Everything in a scene that a picture depends on, for comparisons."""
    if hasattr(value, "__dict__") and not hasattr(value, "parts"):
        return {key: plain(part) for key, part in vars(value).items() if key not in ("hash", "name")}
    return [plain(part) for part in value] if isinstance(value, list) else repr(getattr(value, "tolist", lambda: value)())


class WhatChaptersReadTest(ProgramTest):
    """A reference shows the scene that the chapters show, or there is none. A new key or keyword needs a place above."""

    def known_to_chapters(self, file, pattern):
        source = (PROJECT / "common/scene" / file).read_text()
        return {word for names in re.findall(pattern, source) for word in re.findall(r'"(\w+)"', names)}

    def read(self, scene=None, material=""):
        self.write("other.obj", QUAD_OBJ.replace("v 1 1 0", "v 2 1 0"))
        self.write("quad.obj", QUAD_OBJ + "usemtl rough\nf 1 2 3\n")
        self.write("other.mtl", "newmtl red\nKd 0.5 0 0\n")
        self.write("body.obj", box([0, 0, 0], 1, "body.mtl"))
        self.write("body.mtl", "newmtl a\nd 0\n")
        self.write("quad.mtl", QUAD_MTL + material + "\nnewmtl glossy\nKs 0.1 0.1 0.1\nnewmtl rough\nPr 0.5\n")
        return plain(read_scene(self.write("scene.json", json.dumps(scene or SCENE))))

    def assert_read_or_refused(self, name, usual, other):
        """Whether both pictures are the same, only where the name has no effect."""
        try:
            changed = other()
        except UserError as error:
            self.assertIn(name, str(error))
            return
        self.assertEqual(changed == usual, name in WITHOUT_EFFECT, "is not read")

    def test_every_key_of_a_scene(self):
        known = self.known_to_chapters("scene_file.cpp", r'\{((?:\s*"\w+",?)+)\}')
        self.assertEqual(known, KEYS.keys())
        for key, (place, value) in KEYS.items():
            with self.subTest(key=key):
                scene, usual = copy.deepcopy(SCENE), SCENE
                *outer, last = place.split("/")
                entry = scene
                for part in outer:
                    entry = entry[int(part) if part.isdigit() else part]
                entry[last] = value
                if key in ("intensity", "rotation_degrees"):
                    usual = {**SCENE, "background": PROBE}
                elif key in ("extinction", "albedo", "anisotropy", "density", "box"):
                    usual = {**SCENE, "fog": GRID if key in ("density", "box") else FOG}
                elif key in ("medium", "boundary"):  # these need a body
                    usual = copy.deepcopy(SCENE)
                    usual["meshes"][0]["file"] = entry["file"] = "body.obj"
                    if key == "boundary":
                        usual["meshes"][0]["medium"] = FOG
                material = "Ks 0.1 0.1 0.1"
                self.assert_read_or_refused(key, self.read(usual, material), lambda: self.read(scene, material))

    def test_every_keyword_of_a_material(self):
        known = self.known_to_chapters("material_keywords.h", r'(\{"\w+"), \d')
        self.assertEqual(known, KEYWORDS.keys())
        for keyword, (before, line) in KEYWORDS.items():
            with self.subTest(keyword=keyword):
                scene = {**SCENE, "specular": True}
                usual = self.read(scene, before)
                if keyword == "newmtl":
                    usual, line = self.read(scene, "Kd 0.2 0.2 0.2"), line + "\nKd 0.2 0.2 0.2"
                self.assert_read_or_refused(keyword, usual, lambda: self.read(scene, f"{before}\n{line}"))

    def test_keys_that_nobody_knows(self):
        for place in ("", "meshes/0", "meshes/0/rotation", "camera", "background"):
            with self.subTest(place=place):
                scene = copy.deepcopy(SCENE)
                entry = scene
                for part in filter(None, place.split("/")):
                    entry = entry[int(part) if part.isdigit() else part]
                entry["mist"] = 1
                with self.assertRaisesRegex(UserError, r'scene.json: .*"mist"'):
                    self.read(scene)

    def test_several_scatterings_of_smooth_surfaces_are_none(self):
        self.write("quad.mtl", QUAD_MTL)
        self.write("quad.obj", QUAD_OBJ)
        read_scene(self.write("scene.json", json.dumps({**SCENE, "multiple_scattering": True})))


# A square in front of a larger one, so that it has room on both sides.
LAMP_OBJ = """mtllib lamp.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v -9 -9 -1
v 9 -9 -1
v 0 9 -1
usemtl wall
f 5 6 7
"""
LAMP_MTL = "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl lamp\nKe 1 1 1\nnewmtl dim\nKe 0.5 0.5 0.5\nnewmtl glass\nd 0\nNi 1.5\n"


class LampsInTheSamePlaceTest(ProgramTest):
    """As chapters draw them, which coincident_lights.h says, or refused."""

    def lamps(self, faces, placements=({},)):
        """Materials of the triangles that stay on each side of the square, and the least distance between these sides."""
        self.write("lamp.mtl", LAMP_MTL)
        self.write("lamp.obj", LAMP_OBJ + faces)
        camera = {"position": [0, 0, 9], "target": [0, 0, 0]}
        meshes = [{"file": "lamp.obj", **placement} for placement in placements]
        sides = {1: [], -1: []}
        for surface in read_scene(self.write("scene.json", json.dumps({"meshes": meshes, "camera": camera}))).surfaces:
            for corners in surface.positions:
                x, y = corners[1] - corners[0], corners[2] - corners[0]
                if abs(corners[:, 2]).max() < 0.1:
                    front = 1 if x[0] * y[1] > x[1] * y[0] else -1
                    sides[front].append((surface.material.name, front * corners[0, 2]))
        distances = [min(distance for _, distance in side) for side in sides.values() if side]
        return [[name for name, _ in sides[front]] for front in (1, -1)], sum(distances)

    def test_those_with_two_sides_shine_on_both(self):
        for faces, back in (
            ("usemtl lamp\nf 1 2 3 4\nf 1 4 3 2\n", "lamp"),
            ("usemtl lamp\nf 1 2 3 4\nusemtl dim\nf 1 4 3 2\n", "dim"),
            ("usemtl lamp\nf 1 2 3 4\nusemtl wall\nf 1 4 3 2\n", "wall"),
        ):
            with self.subTest(back=back):
                sides, distance = self.lamps(faces)
                self.assertEqual(sides, [["lamp"] * 2, [back] * 2])
                self.assertGreater(distance, 1e-4)  # so that rays cannot miss it
                self.assertLess(distance, 1e-3)

    def test_the_first_that_emits_stays(self):
        for faces in ("usemtl lamp\nf 1 2 3 4\nusemtl dim\nf 1 2 3 4\n", "usemtl wall\nf 1 2 3 4\nusemtl lamp\nf 1 2 3 4\n"):
            with self.subTest(faces=faces):
                self.assertEqual(self.lamps(faces), ([["lamp"] * 2, []], 0))

    def test_one_that_is_placed_twice_shines_once(self):
        self.assertEqual(self.lamps("usemtl lamp\nf 1 2 3 4\n", ({}, {})), ([["lamp"] * 2, []], 0))
        sides, _ = self.lamps("usemtl lamp\nf 1 2 3 4\nf 1 4 3 2\n", ({}, {}, {}))
        self.assertEqual(sides, [["lamp"] * 2] * 2)

    def test_those_that_only_touch_stay(self):
        sides, _ = self.lamps("usemtl lamp\nf 1 2 3\nf 1 3 4\n", ({}, {"translation": [2, 0, 0]}))
        self.assertEqual(sides, [["lamp"] * 4, []])

    def test_what_is_left_to_chance_is_refused(self):
        quad = "usemtl lamp\nf 1 2 3 4\n"
        for faces, placements in (
            (quad, ({}, {"scale": [1, 1, -1]})),  # the same lamp, turned
            (quad, ({}, {"translation": [0.5, 0, 0]})),  # a part of it
            (quad, ({}, {"scale": 0.5})),
            (quad, ({"scale": 0.5}, {})),
            (quad + "f 4 3 2 1\n", ({},)),  # two triangles of one side meet each of the other
            (quad + "usemtl wall\nf 2 3 4 1\n", ({},)),
            (quad + "usemtl glass\nf 1 2 3 4\n", ({},)),
            ("usemtl lamp\nf 1 2 3 4\nf 1 4 3 2\n", ({}, {"scale": [0.9, 0.9, 1]})),
        ):
            with self.subTest(faces=faces, placements=placements):
                with self.assertRaisesRegex(UserError, "scene.json: a lamp .* by chance.* move one"):
                    self.lamps(faces, placements)


class BodiesTest(ProgramTest):
    """Which medium is on which side of a boundary, and around the camera."""

    def sides(self, meshes, camera=(0, 0, 9), fog=None):
        """Extinctions inside and outside of each body, by its size, and that around the camera; None is clear."""
        self.write("none.mtl", "newmtl a\nKd 1 1 1\n")
        self.write("glass.mtl", "newmtl a\nd 0\n")
        entries = []
        for i, (obj, extinction) in enumerate(meshes):
            medium = {"extinction": extinction, "albedo": 0, **({} if "glass.mtl" in obj else {"boundary": "open"})}
            entries.append({"file": self.write(f"{i}.obj", obj).name, **({"medium": medium} if extinction else {})})
        scene = {"meshes": entries, "camera": {"position": camera, "target": [0, 0, -99]}, **({"fog": fog} if fog else {})}
        read = read_scene(self.write("scene.json", json.dumps(scene)))
        sides = {}
        for surface in read.surfaces:
            for corners in surface.positions:
                media = tuple(medium and medium["extinction"] for medium in (surface.inside, surface.outside))
                sides.setdefault(round(np.ptp(corners, axis=0).max() / 2, 6), set()).add(media)
        return sides, read.camera_medium and read.camera_medium["extinction"]

    def test_a_body_lies_in_the_smallest_one_around_it(self):
        outer, inner = (box([0, 0, 0], 4), 1), (box([1, 0, 0], 0.5), 2)
        for meshes in ([outer, inner], [inner, outer]):
            self.assertEqual(self.sides(meshes), ({4: {(1, None)}, 0.5: {(2, 1)}}, None))
        two = re.sub(r"f .*", lambda f: re.sub(r"\d", lambda i: str(int(i[0]) - 9), f[0]), box([20, 0, 0], 0.25))
        self.assertEqual(self.sides([outer, (inner[0] + two, 2)])[0], {4: {(1, None)}, 0.5: {(2, 1)}, 0.25: {(2, None)}})

    def test_glass_displaces_fog_and_has_its_cavities_filled(self):
        glass, turned = (box([0, 0, 0], 3, "glass.mtl"), None), "3421 6875 2651 7843 5731 4862"
        self.assertEqual(self.sides([glass], fog=FOG), ({3: {(None, 1)}}, 1))
        cavity = box([0, 0, 0], 2, "glass.mtl", turned)
        self.assertEqual(self.sides([glass, (cavity, None)], fog=FOG)[0], {3: {(None, 1)}, 2: {(None, 1)}})
        self.assertEqual(self.sides([(box([0, 0, 0], 2, faces=turned), 5)], fog=FOG)[0], {2: {(1, 5)}})  # behind is outside

    def test_the_camera_is_in_the_medium_around_it(self):
        for z, expected in ((9, 1), (2, 3), (0, 2)):
            self.assertEqual(self.sides([(box([0, 0, 0], 1), 2), (box([0, 0, 0], 4), 3)], (0, 0, z), FOG)[1], expected)
        grid = {**GRID, "density": "0.obj", "extinction": 7}
        self.assertEqual(
            self.sides([(box([0.5] * 3, 0.25), 2), (box([5] * 3, 1), 3)], (0.1, 0.1, 0.1), grid),
            ({0.25: {(2, 7)}, 1: {(3, None)}}, 7),
        )

    def test_what_has_no_clear_inside_is_refused(self):
        whole = (box([0, 0, 0], 1), 1)
        floor = box([0, -9 - 1, 0], 9), None
        for what, meshes in (
            ("not closed", [(box([0, 0, 0], 1, faces="1243 5786 1562 3487 1375"), 1)]),
            ("touches or overlaps", [whole, (box([1.9, 1.9, 1.9], 1), 2)]),  # no centre of a triangle is inside
            ("touches or overlaps", [whole, (box([2, 0, 0], 1), 2)]),
            ("touches or overlaps", [whole, whole]),
            ("touches or overlaps", [whole, (box([0, 0, 0], 1, "glass.mtl"), None)]),
            ("touches or overlaps", [whole, (box([0, -10.0003, 0], 9), None)]),
            ("touches or overlaps", [floor, whole]),
            ("16 open boundaries", [(box([3 * i, 0, 0], 1), 1) for i in range(17)]),
            ("inwards", [(box([0, 0, 0], 1, "glass.mtl", "3421 6875 2651 7843 5731 4862"), 1)]),
        ):
            with self.subTest(what=what, meshes=len(meshes)):
                with self.assertRaisesRegex(UserError, rf"\A[^\n]*scene.json: [^\n]* around \([^\n]*{what}[^\n]*\Z"):
                    self.sides(meshes)
        mixed = box([0, 0, 0], 1, "tinted.mtl").replace("f 1 3 7 5", "usemtl b\nf 1 3 7 5")
        self.write("tinted.mtl", "newmtl a\nd 0\nnewmtl b\nd 0\nTf 0.5 0.5 0.5\n")
        with self.assertRaisesRegex(UserError, "one Tf"):
            self.sides([(mixed, None)], fog=FOG)
        with self.assertRaisesRegex(UserError, '"box" of the fog'):
            self.sides([(box([0.5] * 3, 0.7), 1)], fog={**GRID, "density": "0.obj"})
