"""What goes wrong around a render: full disks, kills, failing devices, unusable caches and folders."""

import os
import random
import shlex
import shutil
import signal
import subprocess
import time

from image_files import Exr
from program import CHAPTER, FAULT_LAYER, UNOPTIMISED, RenderTest


def remove(folder):
    """Removes a folder in which another process creates files."""
    while folder.exists():
        shutil.rmtree(folder, ignore_errors=True)


class FullDisk(RenderTest):
    def test_the_old_file_survives(self):
        """On a file system of 64 KiB in memory, if one can be mounted."""
        namespace = ["unshare", "--map-root-user", "--mount"]
        mount = "mount -t tmpfs -o size=64k tmpfs full"
        (self.folder / "full").mkdir()
        if subprocess.run([*namespace, "sh", "-c", mount], cwd=self.folder, capture_output=True, check=False).returncode != 0:
            self.skipTest("no file system may be mounted")

        def render(size):
            arguments = self.command("--samples=1", "--quiet", "--output=full/a.exr", size=(size, size))
            return shlex.join([str(CHAPTER), *arguments])

        script = f'{mount}; {render(8)}; before=$(cksum full/a.exr); {render(256)}; echo $?; ls -A full; [ "$before" = "$(cksum full/a.exr)" ]'
        result = subprocess.run([*namespace, "sh", "-c", script], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual((result.returncode, result.stdout), (0, "1\na.exr\n"), result.stderr)
        self.assertEqual(result.stderr, "error: full/a.exr: cannot be written: No space left on device\n")


class Kills(RenderTest):
    size = (96, 96)
    fewest, most = 20, 400

    def test_kills_at_any_moment_leave_a_checkpoint(self):
        """Each run continues from what the previous kill left, and writes as often as it can, until several kills hit a write."""
        moments = random.Random(7)
        file, samples = self.folder / "killed.exr", 0
        for kills in range(1, self.most + 1):
            resume = [f"--resume={file}"] if file.exists() else []
            before = file.stat().st_mtime_ns if resume else None
            command = self.command("--samples=4000000000", "--save-every=0.001", "--output", file, *resume, size=self.size)
            with self.start(*command) as process:
                while not file.exists() or file.stat().st_mtime_ns == before:
                    self.assertIsNone(process.poll(), "it cannot go on from the last kill")
                    time.sleep(0.001)
                time.sleep(moments.uniform(0, 0.05))
                process.send_signal(signal.SIGKILL)
                process.communicate()
            left = int(Exr(file).text("samples"))
            self.assertGreaterEqual(left, samples)
            samples = left
            half_written = list(self.folder.glob(".killed.exr.*"))
            if kills >= self.fewest and half_written:
                break
        self.assertTrue(half_written, "no kill came while a file was written")
        resumed = self.picture("resumed", f"--samples={samples + 1}", f"--resume={file}", size=self.size)
        whole = self.picture("whole", f"--samples={samples + 1}", size=self.size)
        self.assert_close(resumed, whole, ulps=kills)  # resuming rounds the mean


class ManyKills_all(Kills):
    fewest, most = 100, 1000


class FailingDevice(RenderTest):
    """A layer between program and driver simulates the device."""

    def refuse(self, fault, *arguments, words):
        code, out, err = self.run_program(
            *self.command("--samples=4000000000", "--quiet", *arguments, size=(64, 64)), environment={**FAULT_LAYER, **fault}
        )
        self.assertEqual((code, out), (3, ""), err)
        self.assertRegex(err, rf"\Aerror: [^\n]*{words}[^\n]*\n\Z")

    def test_a_lost_device_leaves_what_was_read_from_it(self):
        self.refuse({"FAULT_LOSE_DEVICE_AFTER": "30"}, "--save-every=0.01", "--output=a.exr", words="Lost.*samples a pixel")
        left = Exr(self.folder / "a.exr")
        samples = int(left.text("samples"))
        self.assertGreater(samples, 0)
        resumed = self.picture("b", f"--samples={samples + 1}", "--resume=a.exr", size=(64, 64))
        self.assert_close(resumed, self.picture("c", f"--samples={samples + 1}", size=(64, 64)))

    def test_nothing_is_written_in_place_of_an_older_picture(self):
        self.write("a.exr", "older contents")
        self.refuse({"FAULT_LOSE_DEVICE_AFTER": "16"}, "--output=a.exr", words="Lost.*nothing to write")
        self.assertEqual((self.folder / "a.exr").read_text(), "older contents")

    def test_a_device_that_is_lost_early(self):
        for submissions in range(0, 16, 3):
            self.refuse({"FAULT_LOSE_DEVICE_AFTER": str(submissions)}, words="Lost")

    def test_a_lost_device_and_a_folder_that_vanished(self):
        """The exit code reports what happened first."""
        file = self.folder / "folder" / "a.exr"
        command = self.command("--samples=4000000000", "--save-every=0.01", "--output", file, size=(64, 64))
        with self.start(*command, environment={**FAULT_LAYER, "FAULT_LOSE_DEVICE_AFTER": "50"}) as process:
            self.wait_for(file, process)
            remove(file.parent)
            _, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 3, err)
        self.assertRegex(err, r"error: [^\n]*Lost[^\n]*a\.exr: cannot be written[^\n]*\n\Z")

    def test_memory_that_is_used_up(self):
        for backend in ("compute", "auto"):
            arguments = ["cornell_box", "--width=512", "--height=512", "--quiet", f"--backend={backend}"]
            fault = {**FAULT_LAYER, "FAULT_MEMORY_MIB": "1"}
            words = r"\d+ MiB more are needed", r"the device has \d+ MiB"
            self.assert_refused(arguments, "out of device memory", *words, code=3, environment=fault)

    def test_what_does_not_fit_is_refused_before_anything_is_allocated(self):
        """Without any memory, allocating the scene would be a different error."""
        arguments = ["instances", "--width=16384", "--height=16384", "--backend=compute"]
        self.assert_refused(
            arguments, "too large for the device", "11264 MiB", code=3, environment={**FAULT_LAYER, "FAULT_MEMORY_MIB": "0"}
        )


class SmallDevice(RenderTest):
    """A layer between program and driver reports lower limits than the driver has."""

    def assert_same_picture(self, limits, *arguments, scene, size):
        whole = self.picture("whole", *arguments, scene=scene, size=size)
        small = self.picture("small", *arguments, scene=scene, size=size, environment={**FAULT_LAYER, **limits})
        self.assertEqual(whole.pixels(), small.pixels())

    def refuse(self, limits, *words, scene="textured"):
        command = self.command("--samples=1", "--quiet", scene=scene)
        self.assert_refused(command, *words, code=3, environment={**FAULT_LAYER, **limits})

    def test_an_integrated_gpu_works_in_the_memory_of_the_cpu_too(self):
        """The film alone exceeds the device's own memory."""
        self.assert_same_picture({"FAULT_CARVE_OUT_MIB": "8"}, "--samples=1", scene="cornell_box", size=(768, 768))

    def test_memory_that_is_used_up_everywhere(self):
        limits = {"FAULT_CARVE_OUT_MIB": "8", "FAULT_MEMORY_MIB": "12"}
        command = self.command("--samples=1", "--quiet", size=(768, 768))
        self.assert_refused(command, "out of device memory", code=3, environment={**FAULT_LAYER, **limits})

    def test_a_tree_that_is_too_large_for_texel_buffers(self):
        self.assert_same_picture({"FAULT_maxTexelBufferElements": "65536"}, "--samples=1", scene="sunny", size=(48, 40))

    def test_more_textures_than_a_shader_may_see(self):
        for limit in ({"FAULT_maxPerStageDescriptorSampledImages": "5"}, {"FAULT_maxPerStageResources": "21"}):
            self.refuse(limit, "3 textures", "2 at most")

    def test_more_allocations_than_the_device_has(self):
        self.refuse({"FAULT_maxMemoryAllocationCount": "8"}, "too many", "8")  # known before any is made
        self.refuse({"FAULT_maxMemoryAllocationCount": "16"}, "too many", "16")

    def test_an_image_that_is_too_large(self):
        self.refuse({"FAULT_maxImageDimension2D": "64"}, "texture", "64 x 64 at most")


class SharedCache(RenderTest):
    def setUp(self):
        super().setUp()
        self.cache = self.folder / "cache"
        # Two programs that compile the same for `native` are in native_test.py.
        self.environment = {"XDG_CACHE_HOME": str(self.cache), "LAB_WITHOUT_NATIVE": "1", **UNOPTIMISED}

    def render_at_once(self, names, backend):
        """Renders the same picture in several processes at once."""
        command = ["cornell_box", "--width=16", "--height=16", "--samples=2", "--quiet", f"--backend={backend}"]
        running = [self.start(*command, f"--output={name}.exr", environment=self.environment) for name in names]
        for process in running:
            with process:
                out, err = process.communicate(timeout=120)
                self.assertEqual((process.returncode, out, err), (0, "", ""))

    def test_many_processes_fill_an_empty_cache(self):
        self.render_at_once(range(6), "auto")
        entries = [path.name for path in (self.cache / "path_tracing_lab").iterdir()]
        self.assertEqual({name.split("-")[0] for name in entries}, {"backend", "pipelines", "shader"})
        self.assertFalse([name for name in entries if "." in name], "temporary files are left")
        shutil.rmtree(self.cache)
        self.render_at_once(range(6), "compute")
        pictures = [Exr(self.folder / f"{name}.exr").pixels() for name in range(6)]
        self.assertTrue(all(picture == pictures[0] for picture in pictures))

    def test_damaged_entries_count_as_absent(self):
        self.render_at_once(["whole"], "compute")
        entries = {path: path.read_bytes() for path in (self.cache / "path_tracing_lab").iterdir()}
        damages = (
            lambda data: b"",
            lambda data: data[: len(data) // 2],
            lambda data: data[:20] + bytes([data[20] ^ 1]) + data[21:],
            lambda data: os.urandom(len(data)),
        )
        for number, damage in enumerate(damages):
            for path, data in entries.items():
                path.write_bytes(damage(data))
            self.render_at_once([number], "compute")
            self.assertEqual(Exr(self.folder / f"{number}.exr").pixels(), Exr(self.folder / "whole.exr").pixels())
            shaders = {path: data for path, data in entries.items() if path.name.startswith("shader")}
            self.assertEqual({path: path.read_bytes() for path in shaders}, shaders, "entries are not renewed")


class Surroundings(RenderTest):
    bare = {"XDG_CACHE_HOME": None, "DISPLAY": None, "WAYLAND_DISPLAY": None, "XDG_RUNTIME_DIR": None}

    def test_a_home_that_cannot_be_written_or_is_missing(self):
        """Nobody, not even root, can write to /proc."""
        for home in ("/proc", "/proc/nowhere", "quad.obj", "", None):
            with self.subTest(home=home):
                self.render(*self.command("--samples=1", "--quiet", "--output=a.exr"), environment={**self.bare, "HOME": home})
                self.assertEqual(Exr(self.folder / "a.exr").text("samples"), "1")

    def test_without_a_home_nothing_is_kept_where_others_could_replace_it(self):
        environment = {**self.bare, "HOME": None, "TMPDIR": str(self.folder)}
        before = set(self.folder.iterdir())
        self.render(*self.command("--samples=1", "--quiet", "--output=a.exr"), environment=environment)
        self.assertEqual(set(self.folder.iterdir()) - before, {self.folder / "a.exr"})
        self.assertFalse(os.path.exists("/tmp/.cache/path_tracing_lab"))

    def test_a_folder_that_vanishes_while_rendering(self):
        file = self.folder / "folder" / "a.exr"
        with self.start(*self.command("--samples=4000000000", "--quiet", "--save-every=0.05", "--output", file)) as process:
            self.wait_for(file, process)
            remove(file.parent)
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 1, err)
        self.assertRegex(err, r"error: [^\n]*a\.exr: cannot be written: No such file or directory\n\Z")
