"""Long renders: they stop when told to, lose nothing, and continue where they stopped."""

import json
import math
import random
import re
import resource
import signal
import time
from pathlib import Path

from image_files import Exr, relative_mse
from program import BINARIES, MERGE, QUAD_JSON, QUAD_MTL, QUAD_OBJ, UNOPTIMISED, RenderTest, copy_project

SLOW_DISK = {"LD_PRELOAD": str(BINARIES.parent / "layers" / "libslow_disk.so"), "ASAN_OPTIONS": "verify_asan_link_order=0"}


class Interruption(RenderTest):
    """A large image, so that an interruption finds pixels with different sample counts."""

    size = (320, 320)

    def interrupt(self, signal_number, file, *arguments):
        """Interrupts an endless render once it has written the file; returns exit code and output."""
        command = self.command("--samples=4000000000", "--output", file, *arguments, size=self.size)
        with self.start(*command) as process:
            self.wait_for(file, process)
            if signal_number != signal.SIGKILL:
                file.unlink()
            process.send_signal(signal_number)
            out, err = process.communicate(timeout=300)
        return process.returncode, out + err

    def assert_resumes(self, checkpoint):
        """Resumed and uninterrupted renders are identical."""
        total = int(Exr(checkpoint).text("samples")) + 3
        resumed = self.picture("resumed", f"--samples={total}", f"--resume={checkpoint}", size=self.size)
        self.assert_close(resumed, self.picture("uninterrupted", f"--samples={total}", size=self.size))
        self.assertEqual(int(resumed.text("samples")), total)

    def test_what_asks_for_the_end_writes_what_there_is(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU):
            with self.subTest(signal=number):
                file = self.folder / f"stopped{number}.exr"
                code, text = self.interrupt(number, file, "--save-every=0.2")
                self.assertEqual(code, 0, text)
                self.assertIn("--resume", text)
                self.assert_resumes(file)

    def test_a_terminal_that_closes_may_say_so_twice(self):
        """Its shell sends SIGHUP to all programs, and so does the kernel when the shell ends."""
        file = self.folder / "closed.exr"
        with self.start(*self.command("--samples=4000000000", "--output", file, "--save-every=0.2", size=self.size)) as process:
            self.wait_for(file, process)
            for _ in range(20):
                process.send_signal(signal.SIGHUP)
                time.sleep(0.002)
            self.assertIn("--resume", process.communicate(timeout=300)[0])
        self.assertEqual(process.returncode, 0)

    def test_what_the_caller_ignores_is_ignored(self):
        """As nohup and the background jobs of scripts want it."""
        ignored = (signal.SIGINT, signal.SIGHUP, signal.SIGXCPU)
        file = self.folder / "ignored.exr"
        with self.start(
            *self.command("--samples=4000000000", "--output", file, "--save-every=0.2", size=self.size),
            prepare=lambda: [signal.signal(number, signal.SIG_IGN) for number in ignored],
        ) as process:
            self.wait_for(file, process)
            for number in ignored:
                process.send_signal(number)
                for _ in range(3):  # a program that ends writes it twice at most
                    file.unlink()
                    self.wait_for(file, process)
            process.send_signal(signal.SIGTERM)
            self.assertIn("--resume", process.communicate(timeout=300)[0])
        self.assertEqual(process.returncode, 0)

    def test_nobody_needs_to_read_what_it_prints(self):
        file = self.folder / "unread.exr"
        with self.start(*self.command("--samples=2", "--output", file, size=self.size)) as process:
            self.assertIn("cornell_box", process.stdout.readline())  # as `| head -1` does
            process.stdout.close()
            process.stderr.close()
            self.assertEqual(process.wait(timeout=300), 0)
        self.assertTrue(file.exists())

    def test_a_killed_render_goes_on_from_its_checkpoint(self):
        file = self.folder / "killed.exr"
        code, _ = self.interrupt(signal.SIGKILL, file, "--save-every=0.02")
        self.assertEqual(code, -signal.SIGKILL)
        self.assert_resumes(file)

    def test_a_render_resumes_in_its_own_file(self):
        self.picture("same", "--samples=2")
        self.picture("same", "--samples=3", "--resume=same.exr")
        resumed = self.picture("same", "--samples=5", "--resume=same.exr")
        self.assert_close(resumed, self.picture("whole", "--samples=5"))


class AnyMoment:
    """Whatever ends a render, and whenever: the picture has all that was rendered, or the file before it stays."""

    ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGXCPU, None)  # the last one is a time limit
    ENOUGH = 0.7  # seconds, in which a tiny picture doubles its samples many times

    def end(self, backend, number, seconds):
        file = self.write("any.exr", "earlier")
        limit = [] if number else [f"--time-limit={max(seconds, 0.001)}"]
        with self.start(
            "cornell_box",
            "--width=32",
            "--height=32",
            "--samples=4000000000",
            "--headless",
            f"--backend={backend}",
            f"--output={file}",
            *limit,
            environment=UNOPTIMISED,
        ) as process:
            self.assertIn(f"backend {backend}\n", process.stdout.readline())
            if number:
                time.sleep(seconds)
                process.send_signal(number)
            out, err = process.communicate(timeout=300)
        if "before the first sample" in err or number and process.returncode == -number:  # that early, nothing was rendered
            self.assertEqual(file.read_bytes(), b"earlier")
            return
        self.assertEqual((process.returncode, err), (0, ""))
        picture = Exr(file)
        self.assertEqual((picture.width, picture.height), (32, 32))
        printed = re.search(r"^samples +(\d+) a pixel, (\S+(?: \w)?) paths", out, re.MULTILINE)
        self.assertEqual(picture.text("samples"), printed[1])
        self.assertGreater(int(picture.text("rays")), 32 * 32 * int(printed[1]))  # all pixels of all samples

    def end_at(self, moments):
        devices = self.render("--list-devices")
        for backend in ("compute", "query", "pipeline", "native"):
            if not re.search(rf"{backend} +works", devices):
                continue
            for i in range(moments):
                number, seconds = self.ENDS[i % len(self.ENDS)], random.uniform(0, self.ENOUGH)
                with self.subTest(backend=backend, signal=number, seconds=seconds):
                    self.end(backend, number, seconds)


class AnyMomentTest(AnyMoment, RenderTest):
    def test_nothing_is_lost(self):
        self.end_at(6)


class AnyMoment_all(AnyMoment, RenderTest):
    def test_nothing_is_lost(self):
        self.end_at(50)


class Checkpoints(RenderTest):
    def test_a_finished_render_stays_as_it_is(self):
        done = self.picture("done", "--samples=4")
        self.assert_close(self.picture("again", "--samples=4", "--resume=done.exr"), done)

    def test_sample_ranges_resume(self):
        self.picture("part", "--samples=4", "--first-sample=6", "--seed=3")
        resumed = self.picture("resumed", "--samples=9", "--first-sample=6", "--seed=3", "--resume=part.exr")
        self.assert_close(resumed, self.picture("whole", "--samples=9", "--first-sample=6", "--seed=3"))
        self.assertEqual(resumed.text("first_sample"), "6")

    def test_another_render_is_not_resumed(self):
        self.picture("part", "--samples=4")
        others = [
            self.command("--seed=2"),
            self.command("--max-path-length=3"),
            self.command("--view=depth"),
            self.command("--background=1,1,1"),
            self.command(size=(24, 21)),
            self.command(scene="quad.json"),
        ]
        for other in others:
            self.assert_refused([*other, "--samples=8", "--resume=part.exr", "--output=new.exr"], r"part\.exr")

    def test_what_differs_is_named_and_nothing_else(self):
        self.picture("part", "--samples=4")
        self.assert_refused(
            [*self.command("--max-path-length=3", "--samples=8"), "--resume=part.exr", "--output=new.exr"],
            "settings '--max-path-length 8' against '--max-path-length 3'",
        )

    def test_a_merge_keeps_what_it_joins(self):
        self.picture("a", "--samples=2")
        self.picture("b", "--samples=2", "--first-sample=2")
        self.assert_refused(["a.exr", "b.exr", "--output=./a.exr"], "would replace", program=MERGE)

    def test_a_truncated_checkpoint_is_refused(self):
        self.picture("part", "--samples=4")
        whole = (self.folder / "part.exr").read_bytes()
        for size in (100, len(whole) // 2, len(whole) - 1):
            with self.subTest(size=size):
                self.write("cut.exr", whole[:size])
                self.assert_refused(self.command("--samples=8", "--resume=cut.exr"), r"cut\.exr")

    def test_saving_is_not_rendering(self):
        """Where writing takes longer than the interval, half of the time is left for rendering, and only that counts as seconds."""
        start = time.monotonic()
        self.render(
            *self.command("--samples=4000000000", "--save-every=0.001", "--time-limit=3", "--output=saved.exr", size=(320, 320)),
            environment=SLOW_DISK | {"SLOW_DISK_LOG": "log"},
        )
        total = time.monotonic() - start
        renamed = [line.split() for line in (self.folder / "log").read_text(encoding="utf-8").splitlines()]
        saves = [(float(begin), float(end)) for begin, end, file in renamed if file.endswith("saved.exr")]
        self.assertGreater(len(saves), 1)
        saving = sum(end - begin for begin, end in saves)
        self.assertLess(float(Exr(self.folder / "saved.exr").text("seconds")) + saving, total)
        for (begin, end), (next_begin, _) in zip(saves, saves[1:-1]):  # the last one is that of the end
            self.assertGreater(next_begin - end, end - begin)

    def test_a_failed_write_keeps_the_old_file(self):
        """A file size limit, set while the program runs, simulates a full disk."""
        files = [self.folder / f"old.{ending}" for ending in ("exr", "hdr", "png", "jpg", "json")]
        outputs = [argument for file in files[:-1] for argument in ("--output", file)]
        command = self.command("--samples=4000000000", "--save-every=0.2", *outputs, "--report", files[-1])
        with self.start(*command) as process:
            for file in files:
                self.wait_for(file, process)
            resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (100, 100))
            time.sleep(0.5)  # what had begun to be written may still end
            before = [file.read_bytes() for file in files]
            time.sleep(1)  # the render continues: the disk may have room again when it ends
            self.assertIsNone(process.poll())
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 1, err)
        self.assertRegex(err, r"note: [^\n]*old\.exr")
        self.assertRegex(err, r"error: [^\n]*old\.exr[^\n]*\n\Z")
        self.assertEqual([file.read_bytes() for file in files], before)
        self.assertGreaterEqual(min(map(len, before)), 100)
        names = {file.name for file in files} | {"quad.json", "quad.mtl", "quad.obj"}
        self.assertEqual({path.name for path in self.folder.iterdir()}, names)


class EditedShaders(RenderTest):
    """A copy of the project whose shaders are edited between two renders."""

    def setUp(self):
        super().setUp()
        self.tree = self.folder / "tree"
        self.program = copy_project(self.tree, program=BINARIES / "05_russian_roulette")

    def render_range(self, name, first, *arguments):
        command = self.command("--samples=2", "--quiet", f"--first-sample={first}", f"--output={name}.exr", *arguments)
        self.render(*command, program=self.program)

    def edit(self, shader):
        with open(self.tree / shader, "a", encoding="utf-8") as stream:
            stream.write(f"const float added_to_{Path(shader).stem} = 1.0;\n")

    def test_different_estimators_are_not_joined(self):
        for shader in (
            "chapters/05_russian_roulette/path_trace.glsl",
            "chapters/03_next_event_estimation/direct_light.glsl",
            "chapters/02_cosine_sampling/sample_hemisphere.glsl",
            "shaders/world/random.glsl",
            "shaders/world/shading_data.glsl",
        ):
            with self.subTest(shader=shader):
                self.render_range("before", 0)
                self.edit(shader)
                self.render_range("after", 2)
                self.assert_refused(["before.exr", "after.exr", "-o", "merged.exr"], "shader hash", program=MERGE)
                resume = self.command("--samples=4", "--resume=before.exr", "--output=resumed.exr")
                self.assert_refused(resume, "shader hash", program=self.program)

    def test_other_ways_to_trace_rays_are(self):
        self.render_range("before", 0)
        self.edit("shaders/engine/trace_ray/compute.glsl")
        self.edit("shaders/engine/display.comp")
        self.render_range("after", 2)
        self.render("before.exr", "after.exr", "-o", "merged.exr", program=MERGE)


class StoppingEarly(RenderTest):
    def test_target_error_takes_few_looks_and_hardly_more_samples_than_it_needs(self):
        errors, samples = {}, {}
        for target in (0.9, 0.3):
            self.picture("a", "--samples=1000000", f"--target-error={target}", "--report=a.json")
            rows = json.loads((self.folder / "a.json").read_text())["rows"]
            samples[target], errors[target] = rows[-1]["samples"], rows[-1]["rel_rmse"]
            self.assertLessEqual(errors[target], target)
            self.assertGreater(errors[target], 0.8 * target)
            self.assertLess(len(rows), math.log2(samples[target]) + 5)
        # The error falls with the square root, so a third of it takes about nine times as many samples.
        self.assertTrue(5 < samples[0.3] / samples[0.9] < 16, samples)

    def test_target_error_is_met_against_a_reference(self):
        reference = self.picture("reference", "--samples=4096", "--seed=77")
        stopped = self.picture("stopped", "--samples=1000000", "--target-error=0.3", "--reference=reference.exr")
        self.assertLessEqual(math.sqrt(relative_mse(stopped, reference)), 0.3)
        self.assertGreater(math.sqrt(relative_mse(stopped, reference)), 0.1)

    def test_target_error_is_met_without_a_reference(self):
        """The error that the image estimates for itself is close to its error against a good reference."""
        reference = self.picture("reference", "--samples=4096", "--seed=77")
        for target in (2, 0.7, 0.3):
            with self.subTest(target=target):
                stopped = self.picture("stopped", "--samples=1000000", f"--target-error={target}")
                self.assertLessEqual(math.sqrt(relative_mse(stopped, reference)), 2 * target)

    def test_a_film_without_radiance_has_an_unknown_error(self):
        """A lamp so tiny that no path has hit it yet: black does not mean exact."""
        self.write(
            "lamp.obj", QUAD_OBJ.replace("quad.mtl", "lamp.mtl") + "v 0 0 4\nv 0 1e-4 4\nv 1e-4 0 4\nusemtl lamp\nf 5 6 7\n"
        )
        self.write("lamp.mtl", QUAD_MTL + "newmtl lamp\nKe 1e6 1e6 1e6\n")
        scene = json.loads(QUAD_JSON) | {"meshes": [{"file": "lamp.obj"}], "background": {"radiance": [0, 0, 0]}}
        self.write("lamp.json", json.dumps(scene))
        picture = self.picture("a", "--samples=16", "--target-error=0.5", "--report=a.json", scene="lamp.json")
        self.assertEqual(picture.text("samples"), "16")
        rows = json.loads((self.folder / "a.json").read_text())["rows"]
        self.assertEqual([row["samples"] for row in rows], [1, 2, 4, 8, 16])
        self.assertEqual([(row["mean"], row["rel_mse"]) for row in rows], [([0, 0, 0], None)] * len(rows))

    def test_samples_limit_an_error_that_is_out_of_reach(self):
        self.assertEqual(self.picture("a", "--samples=12", "--target-error=1e-9").text("samples"), "12")

    def test_time_limit(self):
        picture = self.picture("a", "--samples=4000000000", "--time-limit=1")
        self.assertGreaterEqual(float(picture.text("seconds")), 0.9)
        self.assertGreater(int(picture.text("samples")), 0)
