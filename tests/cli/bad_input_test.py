"""Scene, mesh and image files that are missing, damaged or absurd: one clear line that names the file, exit code 1."""

import json
import os
import re

import tools_path  # noqa: F401  (first: it finds the others)
import numpy as np
from image_files import Exr
from program import BINARIES, PROJECT, QUAD_MTL, QUAD_OBJ, ProgramTest
from references.exr import rgb_channels, write_exr

SAMPLES_PROBES = BINARIES / "08_light_probes"


class SceneFiles(ProgramTest):
    def refuse(self, name, *words):
        self.assert_refused([name], *words)

    def refuse_text(self, text, *words):
        self.write("bad.json", text)
        self.refuse("bad.json", r"bad\.json", *words)

    def refuse_change(self, key, value, *words):
        """The good scene with one key changed: 'camera.up' is a key inside another one."""
        scene = json.loads((self.folder / "quad.json").read_text())
        *path, last = key.split(".")
        target = scene
        for name in path:
            target = target[int(name) if name.isdigit() else name]
        target[last] = value
        self.refuse_text(json.dumps(scene), *words)

    def test_missing(self):
        self.refuse("nowhere.json", r"nowhere\.json")
        self.refuse("nowhere.obj", r"nowhere\.obj")
        self.refuse("", "scene")

    def test_a_misspelt_scene_lists_all(self):
        self.refuse("cornel_box", "cornel_box: there is no such scene", "cornell_box, focus, fog, furnace, glass,", "torus")

    def test_neither_scene_nor_mesh(self):
        self.write("picture.png", b"\x89PNG")
        self.refuse("picture.png", r"picture\.png", r"\.json", r"\.obj")

    def test_folders_and_devices(self):
        for name in ("folder", "folder.json", "folder.obj"):
            (self.folder / name).mkdir()
            self.refuse(name, name)
        self.refuse("/dev/null")
        self.refuse("/dev/zero")
        os.mkfifo(self.folder / "pipe.json")
        self.refuse("pipe.json", r"pipe\.json")

    def test_empty_truncated_and_binary(self):
        good = (self.folder / "quad.json").read_text()
        noise = bytes(range(256)) * 64
        for text in ("", "   ", good[: len(good) // 2], good[:-3], good + "}", "null", "[]", "3", '"text"', "{}"):
            self.refuse_text(text)
        self.refuse_text(noise)
        self.refuse_text(b"\0" * 1000)
        self.refuse_text(good.replace("quad", "qu\0ad"))

    def test_syntax_errors_name_the_line(self):
        self.refuse_text('{\n  "meshes": [{"file": "quad.obj"}],\n  "camera": {"position": [0, 0, }\n}\n', r"bad\.json:3")

    def test_deep_nesting(self):
        self.refuse_text("[" * 1000000)
        self.refuse_text('{"meshes":' * 100000)

    def test_enormous_files(self):
        for name in ("huge.json", "huge.obj"):
            with open(self.folder / name, "wb") as stream:
                stream.truncate(1 << 40)
            self.refuse(name, name)

    def test_enormous_scenes(self):
        scene = json.loads((self.folder / "quad.json").read_text())
        torus = str(PROJECT / "assets" / "meshes" / "torus.obj")
        scene["meshes"] = [{"file": torus, "translation": [i % 200, 0, -(i // 200)], "scale": 0.3} for i in range(40000)]
        self.write("bad.json", json.dumps(scene))
        self.assert_refused(["bad.json", "--backend=compute"], r"bad\.json", "307200000 triangles")
        if re.search(r"(pipeline|query) +works", self.render("--list-devices")):
            render = ["bad.json", "--backend=auto", "--width=8", "--height=8", "--samples=1", "--output=a.exr"]
            self.assertNotIn("backend compute", self.render(*render))

    def test_unknown_keys(self):
        self.refuse_change("brightness", 1, "brightness")
        self.refuse_change("camera.zoom", 1, "zoom")
        self.refuse_change("meshes.0.rotate", 1, "rotate")
        self.refuse_change("background.colour", 1, "colour")

    def test_wrong_types_and_numbers(self):
        for key, values in {
            "meshes": ({}, 3, "quad.obj", [3], [{}]),
            "meshes.0.file": (3, "", None, "nowhere.obj", "."),
            "meshes.0.scale": ("1", [1, 2], 0, 1e300, [1, 1, 0], None),
            "meshes.0.translation": (1, [1, 2], [1, 2, "3"], [1e300, 0, 0]),
            "meshes.0.rotation": (90, {"degrees": 90}, {"axis": [0, 0, 0], "degrees": 90}, {"axis": [0, 1, 0]}),
            "camera": (1, [], {"position": [0, 0, 1]}),
            "camera.position": ([0, 0], [0, 0, 1e300], [0, 0, 0], "origin"),
            "camera.vertical_fov": (0, 180, -30, "wide", 1e300),
            "camera.aperture_diameter": (-0.1, "wide", 1e300, None, [0.1]),
            "camera.focus_distance": (0, -1, "far", 1e300, 1e-60),
            "fog": (1, {}, {"extinction": -1, "albedo": 1}, {"extinction": 1, "albedo": 2}, {"extinction": "1", "albedo": 1}),
            "meshes.0.medium": (1, {}, {"extinction": 1, "albedo": 1, "boundary": "closed"}),
            "background": (1, [1, 1, 1], {}, {"radiance": [1, 1, -1]}, {"light_probe": "nowhere.hdr"}),
            "width": (0, -1, 1.5, "big", 1e9, 100000000000000),
            "samples": (0, -1, 1.5, "many"),
            "max_path_length": (-1, 1.5, "long", 1e12),
            "specular": (1, "yes", []),
            "description": (1, []),
        }.items():
            for value in values:
                self.refuse_change(key, value)

    def test_numbers_beyond_floats(self):
        good = (self.folder / "quad.json").read_text()
        for key, value in (("camera.vertical_fov", 1e300), ("meshes.0.scale", 1e300), ("meshes.0.translation", [1e300, 0, 0])):
            self.refuse_change(key, value, "32 bits")
        for focus in (-1, "infinity"):
            self.refuse_change("camera.focus_distance", focus, r"must be a number above 0 \(1e18 is infinity\)")
        for number in ("NaN", "Infinity", "1e999", "-1e999"):
            self.refuse_text(good.replace("40", number))


class MeshFiles(ProgramTest):
    def refuse(self, *words, obj=QUAD_OBJ, mtl=QUAD_MTL):
        self.write("bad.mtl", mtl)
        self.write("bad.obj", obj if isinstance(obj, bytes) else obj.replace("quad.mtl", "bad.mtl"))
        self.assert_refused(["bad.obj", "--background=1,1,1"], *words)

    def test_empty_and_binary(self):
        self.refuse(r"bad\.obj", obj="")
        self.refuse(r"bad\.obj", obj="# nothing\n")
        self.refuse(r"bad\.obj", obj=bytes(range(256)) * 64)
        self.refuse(r"bad\.obj", obj=b"\0" * 1000)

    def test_wrong_indices(self):
        for face in ("f 1 2 9", "f 0 1 2", "f 1 2 -9", "f 1 2 99999999999", "f 1/7 2/7 3/7", "f 1//7 2//7 3//7", "f a b c"):
            self.refuse(r"bad\.obj:8", obj=QUAD_OBJ + face + "\n")

    def test_faces_with_too_few_corners(self):
        for face in ("f 1 2", "f 1", "f"):
            self.refuse(r"bad\.obj:8", obj=QUAD_OBJ + face + "\n")

    def test_coordinates_that_are_no_numbers(self):
        for vertex in ("v nan 0 0", "v 0 inf 0", "v 0 0 1e99", "v 0 0", "v a b c"):
            self.refuse(r"bad\.obj:8", obj=QUAD_OBJ + vertex + "\nf 1 2 5\n")

    def test_materials(self):
        for line in ("Kd nan 0 0", "Kd 1e99 0 0", "Kd -1 0 0", "Ke inf 0 0", "Ke -1 0 0", "Kd red", "Ns -3", "d 7"):
            self.refuse(r"bad\.mtl:3", mtl=QUAD_MTL + line + "\n")

    def test_materials_that_are_nowhere_are_grey(self):
        for line, note in (
            (("usemtl white", "usemtl red"), r'bad\.obj:6: there is no material "red"'),
            (("quad.mtl", "nowhere.mtl"), r'bad\.obj:1: there is no material file "nowhere\.mtl"'),
        ):
            self.write("bad.obj", QUAD_OBJ.replace(*line))
            render = ["bad.obj", "--background=1,1,1", "--width=8", "--height=8", "--samples=1", "--output=a.exr"]
            code, out, err = self.run_program(*render)
            with self.subTest(line=line):
                self.assertEqual(code, 0, err)
                self.assertEqual(len(re.findall("grey", out + err)), 1)
                self.assertRegex(out + err, note + ": 1 faces without a material are drawn in grey")

    def test_dielectrics_belong_to_chapter_6(self):
        for line in ("d 0.5", "Tr 0.5", "d 0"):
            self.refuse("chapter 6", mtl=QUAD_MTL + line + "\nNi 1.5\n")


def one_coloured_hdr(width, height):
    """A light probe with radiance 1 everywhere, in uncompressed rows."""
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (height, width) + bytes([128, 128, 128, 129]) * (
        width * height
    )


class ImageFiles(ProgramTest):
    def damaged(self):
        """Contents that every image reader must refuse."""
        exr = bytes.fromhex("762f3101") + bytes([2, 0, 0, 0])
        png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x08\x06\0\0\0"
        hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000000 +X 2000000000\n"
        return [b"", b"\0" * 100, bytes(range(256)) * 64, exr, exr + b"\xff" * 100, png, hdr, hdr.replace(b"2000000000", b"8")]

    def refuse(self, *arguments, names):
        for name in names:
            for contents in self.damaged():
                self.write(name, contents)
                self.assert_refused([*arguments[:1], *(str(a).format(name) for a in arguments[1:])], name)

    def test_textures(self):
        for name in ("bad.png", "bad.jpg"):
            self.write("quad.mtl", QUAD_MTL + f"map_Kd {name}\n")
            self.write("quad.obj", QUAD_OBJ.replace("f 1 2 3 4", "vt 0 0\nf 1/1 2/1 3/1 4/1"))
            self.refuse("quad.json", names=[name])
            (self.folder / name).unlink()
            self.assert_refused(["quad.json"], name)

    def use_light_probe(self, name, contents=b""):
        scene = json.loads((self.folder / "quad.json").read_text())
        scene["background"] = {"light_probe": name}
        self.write("quad.json", json.dumps(scene))
        return self.write(name, contents)

    def test_light_probes(self):
        for name in ("bad.hdr", "bad.exr"):
            self.use_light_probe(name)
            self.refuse("quad.json", names=[name])

    def test_light_probes_with_impossible_radiance(self):
        for number in (float("nan"), float("inf"), -0.5):
            radiance = np.ones((2, 4, 3), np.float32)
            radiance[1, 2, 0] = number
            write_exr(self.use_light_probe("bad.exr"), rgb_channels(radiance), {})
            self.assert_refused(
                ["quad.json"], r"bad\.exr: pixel \(2, 1\) is negative, infinite or not a number", program=SAMPLES_PROBES
            )

    def test_light_probes_that_are_too_large(self):
        for width, height in ((16385, 1), (1, 16385)):
            self.use_light_probe("bad.hdr", one_coloured_hdr(width, height))
            self.assert_refused(
                ["quad.json"], rf"bad\.hdr: an image of {width} x {height} pixels", "16384", program=SAMPLES_PROBES
            )

    def test_light_probes_of_any_shape_cover_the_sphere(self):
        options = ["--width=16", "--height=16", "--samples=256", "--max-path-length=1", "--backend=compute", "--quiet"]

        def mean():
            self.render("quad.json", *options, "--output=a.exr", program=SAMPLES_PROBES)
            return Exr(self.folder / "a.exr").mean()[0]

        sky = mean()
        for width, height in ((1, 1), (5, 5), (3, 8), (16384, 1), (1, 16384)):
            self.use_light_probe("odd.hdr", one_coloured_hdr(width, height))
            with self.subTest(width=width, height=height):
                self.assertAlmostEqual(mean() / sky, 1, delta=0.02)

    def test_references_and_checkpoints(self):
        self.refuse("quad.json", "--reference={}", names=["bad.exr"])
        self.refuse("quad.json", "--resume={}", names=["bad.exr"])
        for option in ("--reference", "--resume"):
            self.assert_refused(["quad.json", f"{option}=nowhere.exr"], r"nowhere\.exr")
            self.assert_refused(["quad.json", f"{option}=quad.obj"], r"quad\.obj")
