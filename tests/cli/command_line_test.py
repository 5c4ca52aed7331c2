"""The command line: what it accepts, and that it refuses everything else with one clear line."""

import re
import resource
import signal
from pathlib import Path

from image_files import Exr
from program import BINARIES, CHAPTER, MERGE, QUAD_JSON, QUAD_MTL, ProgramTest

OPTIONS = """--width --height --samples --seed --first-sample --max-path-length --only-path-length --backend --device
    --list-devices --headless --window --output --reference --report --target-error --time-limit --view --camera-position
    --camera-target --camera-up --vertical-fov --background --specular --exposure --resume --save-every --validation
    --quiet --batch --help --version""".split()

NO_NUMBERS = ["", "abc", "nan", "inf", "-inf", "1e999", "0x", "1,", "--"]
NO_COUNTS = NO_NUMBERS + ["-1", "1.5", "99999999999999999999"]


class Information(ProgramTest):
    def test_help_names_every_option_of_the_contract(self):
        out = self.render("--help")
        for option in OPTIONS:
            self.assertRegex(out, rf"{option}\b")
        for option, default in (("width", 512), ("samples", 64), ("max-path-length", 8)):
            self.assertRegex(out, rf"--{option} ((?!--)[^;])*;\s+default:\s+the\s+scene's,\s+or\s+else\s+{default}\n")

    def test_help_names_the_exit_codes(self):
        for program in (CHAPTER, MERGE):
            self.assertRegex(self.render("--help", program=program), r"Exit codes: 0 done, 1 bad input or usage")

    def test_options_without_effect_are_noted(self):
        lens, media = BINARIES / "12_lens", BINARIES / "13_media"
        self.write("foggy.json", '{"meshes": [{"file": "quad.obj"}], "fog": {"extinction": 1, "albedo": [0.5, 0.5, 0.5]}}')
        for program, options, words in (
            (CHAPTER, ["--aperture-diameter=1"], "--aperture-diameter: 01_uniform_sampling leaves out its lens"),
            (CHAPTER, ["--focus-distance=1"], "--focus-distance has no effect"),
            (lens, ["--focus-distance=1"], "on a pinhole: give --aperture-diameter"),
            (lens, ["--focus-distance=1", "--aperture-diameter=0.1"], None),
            (lens, ["--focus-distance=1", "--view=focus"], None),
            (CHAPTER, ["--specular"], "--specular has no effect"),
            (CHAPTER, ["--exposure=1", "--output=a.exr", "--output=a.hdr"], "--exposure has no effect"),
            (CHAPTER, ["--exposure=1", "--view=normals"], "--exposure has no effect"),
            (CHAPTER, ["--exposure=1", "--output=a.exr", "--output=a.jpg"], None),
            (CHAPTER, ["--exposure=1"], None),  # the default outputs have a PNG
            (media, ["--background=1,1,1"], None),
            (media, ["foggy.json", "--background=1,1,1"], "--background has no effect"),
            (CHAPTER, ["--max-threads-per-pixel=2", "--backend=compute"], None),
        ):
            scene = [] if "foggy.json" in options else ["quad.json"]
            _, _, err = self.run_program(*scene, "--width=4", "--height=4", "--samples=1", *options, program=program)
            self.assertRegex(err, rf"\Anote: [^\n]*{words}[^\n]*\n\Z" if words else r"\A\Z", options)

    def test_a_picture_without_light_is_noted(self):
        self.write("dark.json", '{"meshes": []}')
        for options, words in (
            ([], "note: dark.json: nothing emits light"),
            (["--background=1,1,1"], None),
            (["--view=normals"], None),
        ):
            _, _, err = self.run_program("dark.json", "--width=4", "--height=4", "--samples=1", *options)
            self.assertRegex(err, rf"\A{words}[^\n]*\n\Z" if words else r"\A\Z", options)

    def test_a_folder_does_not_hide_a_scene(self):
        (self.folder / "furnace").mkdir()
        self.render("furnace", "--width=4", "--height=4", "--samples=1")

    def test_a_scene_in_a_tall_picture_is_seen_whole(self):
        for size in (["--width=64", "--height=16"], ["--width=16", "--height=64"]):
            self.render("quad.obj", *size, "--samples=1", "--view=depth", "--output=depth.exr")
            picture = Exr(self.folder / "depth.exr")
            seen = [place for place, depth in enumerate(picture.channels["R"]) if depth]
            columns, rows = {place % picture.width for place in seen}, {place // picture.width for place in seen}
            self.assertTrue(0 < min(columns) and max(columns) < picture.width - 1, columns)
            self.assertTrue(0 < min(rows) and max(rows) < picture.height - 1, rows)

    def test_version(self):
        self.assertRegex(self.render("--version"), r"\A01_uniform_sampling \d+\.\d+\S*\n\Z")

    def test_list_devices(self):
        out = self.render("--list-devices")
        self.assertRegex(out, r"(?m)^0\b.*Vulkan 1\.\d")
        for backend in ("pipeline", "query", "compute"):
            self.assertRegex(out, rf"{backend} +(works|lacks \w+)")
        self.assertGreaterEqual(int(re.search(r"largest image (\d+) megapixels\n", out)[1]), 16)

    def test_a_render_tells_what_it_did(self):
        out = self.render("quad.json", "--width", 8, "--height", 8, "--samples", 4)
        self.assertRegex(out, r"mean radiance +[\d.e+-]+ [\d.e+-]+ [\d.e+-]+")
        self.assertRegex(out, r"rays/s")
        self.assertIn("output/01_uniform_sampling.png", out)
        self.assertIn("output/01_uniform_sampling.exr", out)
        written = {path.name for path in (self.folder / "output").iterdir()}
        self.assertEqual(written, {"01_uniform_sampling.png", "01_uniform_sampling.exr"})

    def test_a_view_tells_a_mean_but_no_error_of_a_radiance_that_it_does_not_show(self):
        out = self.render("quad.json", "--width", 8, "--height", 8, "--samples", 4, "--view", "normals")
        self.assertRegex(out, r"(?m)^mean +[\d.e+-]+ [\d.e+-]+ [\d.e+-]+")
        self.assertNotRegex(out, r"radiance|(?m:^(error|noise) )")

    def test_zeros_in_front_of_a_number_do_not_matter(self):
        out = self.render("quad.json", "--width=008", "--height=00008", "--samples=0000000000010", "--seed=09")
        self.assertRegex(out, r", 8x8, 10 samples,")

    def test_quiet_prints_nothing(self):
        code, out, err = self.run_program("quad.json", "--width", 8, "--height", 8, "--samples", 1, "--quiet")
        self.assertEqual((code, out, err), (0, "", ""))


class NotOnWindows(ProgramTest):
    """Windows has no backend `native`, and names the home folder otherwise."""

    def test_a_limit_of_threads_has_no_effect_on_native(self):
        options = ["--width=4", "--height=4", "--samples=1", "--max-threads-per-pixel=2", "--backend=native"]
        _, _, err = self.run_program("quad.json", *options)
        self.assertRegex(err, r"\Anote: [^\n]*--max-threads-per-pixel has no effect[^\n]*\n\Z")

    def test_paths_from_the_home_folder(self):
        self.render(
            "quad.json", "--width=4", "--height=4", "--samples=1", "--output=~/home.exr", environment={"HOME": str(self.folder)}
        )
        self.render("--output=~/merged.exr", "home.exr", program=MERGE, environment={"HOME": str(self.folder)})
        self.assertTrue((self.folder / "home.exr").exists() and (self.folder / "merged.exr").exists())
        self.assertFalse((self.folder / "~").exists())


class WrongArguments(ProgramTest):
    def refuse(self, option, value, *words):
        self.assert_refused(["quad.json", f"{option}={value}", "--samples=1000000000"], option, *words)

    def test_unknown_options(self):
        for option in ("--no-such-option", "--width-of-image=3", "-x", "--sample"):
            self.assert_refused(["quad.json", option], re.escape(option.split("=")[0]))

    def test_a_second_scene(self):
        self.assert_refused(["quad.json", "quad.obj"], "quad.obj")

    def test_missing_values(self):
        for option in ("--width", "--output", "--background", "--device"):
            self.assert_refused(["quad.json", option], option)

    def test_counts(self):
        for option in ("--width", "--height", "--samples", "--max-path-length", "--only-path-length", "--seed"):
            for value in NO_COUNTS:
                self.assert_refused(["quad.json", f"{option}={value}"], option)
        self.assert_refused(["quad.json", "--first-sample=-1"], "--first-sample")

    def test_counts_that_must_be_positive_or_are_too_large(self):
        for option, value in (("--width", 0), ("--height", 0), ("--samples", 0), ("--width", 1000000)):
            self.refuse(option, value)

    def test_numbers(self):
        for option in ("--target-error", "--time-limit", "--vertical-fov", "--exposure", "--save-every"):
            for value in NO_NUMBERS:
                self.refuse(option, value)

    def test_numbers_out_of_range(self):
        for option, values in {
            "--target-error": (0, -1),
            "--time-limit": (0, -1),
            "--vertical-fov": (0, -10, 180, 400),
            "--exposure": (1e9, -1e9),
            "--save-every": (0, -1),
            "--width": (0, 16385, 10**30),
            "--camera-position": ("1e31,0,0",),
            "--background": ("1,1,1e31", "1,1,-1"),
            "--focus-distance": (0, 1e31),
        }.items():
            for value in values:
                self.refuse(option, value, r" from \S+ to \S+")
        for value in ("inf", "infinity"):
            self.refuse("--focus-distance", value, "1e18 is infinity")

    def test_vectors(self):
        for option in ("--camera-position", "--camera-target", "--camera-up", "--background"):
            for value in NO_NUMBERS + ["1", "1,2", "1,2,3,4", "1,2,nan", "1,inf,3", "1,2,x", "1,,3"]:
                self.refuse(option, value)
        self.refuse("--background", "1,-1,1")

    def test_cameras_without_a_direction(self):
        self.assert_refused(["quad.json", "--camera-position=1,2,3", "--camera-target=1,2,3"], "camera")
        self.assert_refused(["quad.json", "--camera-up=0,0,0"], "camera|up")

    def test_choices(self):
        self.refuse("--backend", "raster", "pipeline", "query", "compute")
        self.refuse("--view", "nothing", "normals", "bvh-steps")
        for view in ("idle-lanes", "bvh-steps"):
            self.assert_refused(["quad.json", f"--view={view}", "--backend=pipeline"], "pipeline", "compute")

    def test_more_samples_than_random_numbers(self):
        self.assert_refused(["quad.json", "--first-sample=4294967295", "--samples=2"], "--first-sample")

    def test_options_that_contradict_each_other(self):
        self.assert_refused(["quad.json", "--only-path-length=5", "--max-path-length=4"], "--only-path-length")


class WrongOutputs(ProgramTest):
    """Detected before rendering: this many samples would take longer than the test may."""

    def refuse(self, name, *words, option="--output"):
        self.assert_refused(["quad.json", "--samples=4000000000", option, name], *words)

    def test_endings(self):
        for name in ("picture.gif", "picture", "picture.exr.txt", "exr"):
            self.refuse(name, re.escape(name), r"\.exr", r"\.png")
        self.refuse("report.txt", "report.txt", r"\.json", r"\.csv", option="--report")

    def test_unwritable_places(self):
        (self.folder / "folder.exr").mkdir()
        (self.folder / "folder.json").mkdir()
        for name in ("quad.obj/picture.exr", "folder.exr", "/proc/picture.exr", "x" * 300 + ".exr", ""):
            self.refuse(name)
        for name in ("quad.obj/report.json", "folder.json", "/proc/report.json"):
            self.refuse(name, option="--report")

    def test_files_that_the_picture_is_made_from(self):
        self.render("quad.json", "--width=8", "--height=4", "--samples=1", "--output=sky.exr", "--output=map.png")
        self.write("quad.mtl", QUAD_MTL + "map_Kd map.png\n")
        self.write("quad.json", QUAD_JSON.replace('"radiance": [1, 1, 1]', '"light_probe": "sky.exr"'))
        (self.folder / "link.exr").symlink_to("sky.exr")
        for option, name in (
            ("--report", "quad.json"),
            ("--output", "map.png"),
            ("--output", "./sky.exr"),
            ("--output", "link.exr"),
        ):
            self.refuse(name, re.escape(name), "choose another name", option=option)
        (self.folder / "reference.exr").write_bytes((self.folder / "sky.exr").read_bytes())
        self.assert_refused(
            [
                "quad.json",
                "--width=8",
                "--height=4",
                "--samples=4000000000",
                "--reference=reference.exr",
                "--output=reference.exr",
            ],
            r"reference\.exr",
            "choose another name",
        )

    def test_one_bad_output_of_two(self):
        self.assert_refused(
            ["quad.json", "--samples=4000000000", "--output", "good.png", "--output", "quad.obj/bad.png"], "bad.png"
        )


class Devices(ProgramTest):
    def test_unknown_devices(self):
        for device in ("99", "-1", "No Such Device"):
            self.assert_refused(["quad.json", f"--device={device}"], re.escape(device), "--list-devices", code=2)

    def test_a_name_stands_for_one_device(self):
        """Numbers, too, are parts of names: a user means 4090 by 4090."""
        drivers = sorted(Path("/usr/share/vulkan/icd.d").glob("lvp_icd*.json"))
        if not drivers:
            self.skipTest("Mesa's driver for CPUs is not installed")
        copies = [self.write(f"{i}.json", drivers[0].read_bytes()) for i in range(2)]
        one, two = (
            {name: ":".join(map(str, files)) for name in ("VK_DRIVER_FILES", "VK_ICD_FILENAMES")}
            for files in (copies[:1], copies)
        )
        name = re.match(r"0  (llvmpipe \(LLVM .*?(\d+) bits\))", self.render("--list-devices", environment=two))
        for choice in (name[1], "LLVMpipe", name[2], "0"):
            arguments = [
                "quad.json",
                "--headless",
                "--width=8",
                "--height=8",
                "--samples=1",
                "--backend=compute",
                "--device",
                choice,
            ]
            self.assertIn(name[1], self.render(*arguments, environment=one))
            if choice != "0":
                self.assert_refused(arguments, re.escape(choice), "choose by number, such as --device 0", code=2, environment=two)

    def test_backends_work_or_are_refused(self):
        devices = self.render("--list-devices")
        first = re.split(r"(?m)^1\b", devices)[0]
        for backend in ("pipeline", "query", "compute"):
            with self.subTest(backend=backend):
                arguments = ["quad.json", "--width=8", "--height=8", "--samples=1", "--device=0", "--backend", backend]
                if re.search(rf"{backend} +works", first):
                    self.assertIn(f"backend {backend}", self.render(*arguments))
                else:
                    self.assert_refused(arguments, backend, code=2)

    def test_a_machine_without_vulkan_driver(self):
        nowhere = {"VK_DRIVER_FILES": "/nonexistent", "VK_ICD_FILENAMES": "/nonexistent"}
        self.assert_refused(["quad.json"], "VK_DRIVER_FILES is ./nonexistent.: unset it", code=2, environment=nowhere)
        self.assert_refused(["--list-devices"], "VK_DRIVER_FILES is ./nonexistent.: unset it", code=2, environment=nowhere)

    def test_a_crash_under_a_limit_of_memory_names_it(self):
        """Mesa crashes where it gets no memory. Here the signal comes from outside."""
        limit = 64 << 30
        for prepare, code, words in (
            (lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)), 3, "limit of memory is too low"),
            (None, -signal.SIGSEGV, ""),
        ):
            with self.start(
                "quad.json", "--samples=4000000000", "--backend=compute", "--save-every=0.01", "--output=a.exr", prepare=prepare
            ) as process:
                self.wait_for(self.folder / "a.exr", process)
                process.send_signal(signal.SIGSEGV)
                err = process.communicate(timeout=300)[1]
            self.assertEqual(process.returncode, code, err)
            self.assertIn(words, err)

    def test_an_image_too_large_for_the_device_is_refused(self):
        arguments = ["quad.json", "--width=16384", "--height=16384", "--samples=1"]
        self.assert_refused(arguments, "11264 MiB", r"it (allows|has) \d+ MiB", "smaller", code=3)


class MergeArguments(ProgramTest):
    def test_wrong_arguments(self):
        self.assert_refused([], "-o|merge", program=MERGE)
        self.assert_refused(["a.exr", "b.exr"], "-o", program=MERGE)
        self.assert_refused(["-o", "c.exr"], program=MERGE)
        self.assert_refused(["a.exr", "b.exr", "-o", "c.exr"], "a.exr", program=MERGE)
        self.assert_refused(["quad.obj", "-o", "c.exr"], "quad.obj", program=MERGE)
        self.assert_refused(["a.exr", "-o", "c.png"], "c.png", r"\.exr", program=MERGE)

    def test_help(self):
        self.assertIn("-o", self.render("--help", program=MERGE))
