"""The backend native: its compiler, its lanes, and what goes wrong with them."""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from unittest import mock

from program import ProgramTest  # first: it finds the tools
from copied_lab import CopiedLab
from image_files import Exr
from check import command as check_command
from references.images import read_rgb


class AutomaticNativeTest(CopiedLab, ProgramTest):
    """--backend auto may choose native on a CPU."""

    @classmethod
    def setUpClass(cls):
        cls.measured = Path(cls.enterClassContext(tempfile.TemporaryDirectory())) / "cache"

    def automatic(self, chosen, **environment):
        """Renders after a measurement that has found a backend to be the fastest. Backends are measured once for all tests."""
        if self.measured.exists():
            shutil.copytree(self.measured, self.tree / "cache")
        self.assertEqual(self.render(backend="auto", **environment).returncode, 0)
        if not environment and not self.measured.exists():
            shutil.copytree(self.tree / "cache", self.measured)
        for entry in (self.tree / "cache/path_tracing_lab").glob("backend-*"):
            checksum = 0xCBF29CE484222325
            for byte in chosen:
                checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
            entry.write_bytes(chosen + checksum.to_bytes(8, "little"))
        return self.render(backend="auto", **environment)

    def test_it_uses_what_is_fastest(self):
        for name in ("native", "compute"):
            self.assertIn(f"backend {name}\n", self.automatic(name.encode()).stdout)
            shutil.rmtree(self.tree / "cache")

    def test_a_shader_that_native_cannot_run_is_rendered_all_the_same(self):
        self.automatic(b"native")
        process = self.render(backend="auto", **self.compiler("echo broken; exit 1\n"))
        self.assertEqual(process.returncode, 0, process.stderr)
        self.assertRegex(process.stderr, r"\Anote: [^\n]* does not compile its code: broken[^\n]* renders instead\n\Z")
        self.assertRegex(process.stdout, "backend (compute|query|pipeline)\n")
        self.assertIn("backend native\n", self.render(backend="auto").stdout)  # the choice is still known

    def test_what_no_backend_can_run_is_one_error(self):
        self.automatic(b"native")
        self.shader.write_text("nothing", encoding="utf-8")
        process = self.render(backend="auto")
        self.assertEqual((process.returncode, process.stderr.count("note")), (1, 0), process.stderr)

    def test_it_needs_permission(self):
        self.assertRegex(self.automatic(b"native", LAB_WITHOUT_NATIVE="1").stdout, "backend (compute|query|pipeline)\n")


class InterruptedCompilerTest(CopiedLab, ProgramTest):
    """Whoever stops a program that compiles a shader, or starts two of them, finds nothing unfinished in the cache."""

    def test_two_that_compile_the_same(self):
        command_line = [self.program, *self.SIZE, "--backend=native"]
        environment = os.environ | {"XDG_CACHE_HOME": str(self.tree / "cache")}
        both = [subprocess.Popen([*command_line, f"--output={i}.exr"], cwd=self.tree, env=environment) for i in range(2)]
        self.assertEqual([process.wait(120) for process in both], [0, 0])
        self.assertEqual({file.suffix for file in (self.tree / "cache/path_tracing_lab").glob("native-*")}, {""})

    def test_it_leaves_no_files(self):
        environment = self.compiler(f'echo half a program > "$3"; echo > {self.folder}/started; exec sleep 60\n')
        environment["XDG_CACHE_HOME"] = str(self.tree / "cache")
        for to_all, number in ((True, signal.SIGINT), (False, signal.SIGINT), (False, signal.SIGTERM), (False, signal.SIGHUP)):
            with self.subTest(signal=number, to_all=to_all):
                with self.start(
                    *self.SIZE, "--backend=native", environment=environment, program=self.program, prepare=os.setsid
                ) as process:
                    self.wait_for(self.folder / "started", process)
                    os.killpg(process.pid, number) if to_all else process.send_signal(number)
                    process.communicate(timeout=300)
                self.assertEqual(process.returncode, -number)
                self.assertEqual(list((self.tree / "cache/path_tracing_lab").glob("native-*")), [])
                (self.folder / "started").unlink()

    def test_a_signal_that_comes_at_once_is_heard(self):
        def let_the_compiler_run_first():
            os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
            os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))  # who starts a program waits for the core

        environment = self.compiler("kill -TERM $PPID\nexec sleep 60\n") | {"XDG_CACHE_HOME": str(self.tree / "cache")}
        for _ in range(3):
            with self.start(
                *self.SIZE, "--backend=native", environment=environment, program=self.program, prepare=let_the_compiler_run_first
            ) as process:
                process.communicate(timeout=300)
            self.assertEqual(process.returncode, -signal.SIGTERM)


class Lanes_all(CopiedLab, ProgramTest):
    """How many paths run at once is said, with the reason if it is one."""

    def test_one_variable_turns_lanes_off(self):
        cpu = Path("/proc/cpuinfo").read_text(encoding="utf-8")
        if " avx2 " not in cpu:
            self.skipTest("the CPU lacks AVX2")
        for how, arguments, environment in (
            (f"{16 if ' avx512dq ' in cpu else 8} paths at a time", [], {}),
            ("8 paths at a time", [], {"LAB_LANES": "8"}),
            ("1 path at a time: LAB_LANES=0", [], {"LAB_LANES": "0"}),
            ("1 path at a time: --sanitize", ["--sanitize"], {}),
        ):
            self.assertIn(f"\neach core      traces {how}\n", self.render(*arguments, **environment).stdout)


class NativeFailures_all(CopiedLab, ProgramTest):
    """What can go wrong when shaders are compiled into programs."""

    def assert_error(self, process, code, *words):
        self.assertEqual(process.returncode, code, process.stderr)
        self.assertEqual(process.stderr.count("\n"), 1, process.stderr)
        for word in words:
            self.assertIn(word, process.stderr)

    def test_without_a_compiler(self):
        self.assert_error(self.render(PATH=str(self.tree)), 2, "a C++ compiler", "these work on it", "compute")
        process = subprocess.run(
            [self.program, "--list-devices"], capture_output=True, encoding="utf-8", env=os.environ | {"PATH": ""}
        )
        self.assertRegex(process.stdout, r"native +lacks a C\+\+ compiler")

    def test_submissions_stay_in_the_driver(self):
        self.assert_error(self.render(LAB_WITHOUT_NATIVE="1"), 2, "LAB_WITHOUT_NATIVE")
        for backend, wanted in (("auto", "1"), ("native", None)):
            with (
                mock.patch.dict(os.environ),
                mock.patch.object(sys, "argv", ["check", "1", "--backend", backend]),
                mock.patch.object(check_command, "check", side_effect=SystemExit(0)),
            ):
                os.environ.pop("LAB_WITHOUT_NATIVE", None)
                with self.assertRaises(SystemExit):
                    check_command.main()
                self.assertEqual(os.environ.get("LAB_WITHOUT_NATIVE"), wanted)

    def test_a_compiler_that_fails(self):
        self.assert_error(
            self.render(**self.compiler("echo broken; exit 1\n")), 1, "does not compile", "broken", "--backend compute"
        )
        self.assertEqual(list((self.tree / "cache/path_tracing_lab").glob("*.cpp")), [])

    def test_a_cache_that_was_damaged_is_compiled_anew(self):
        self.assertEqual(self.render().returncode, 0)
        code = max((self.tree / "cache/path_tracing_lab").glob("native-*"), key=os.path.getsize)  # the other one calls Embree
        good = code.read_bytes()
        for bad in (b"", good[:1000], good[:-9] + b"x" + good[-8:]):
            code.unlink()  # a program that runs it keeps its own copy
            code.write_bytes(bad)
            self.assertEqual(self.render().returncode, 0)
            self.assertEqual(len(code.read_bytes()), len(good))
        self.assertEqual(self.render(**self.compiler("exit 1\n")).returncode, 1)  # another compiler produces other code

    def test_a_cache_that_forbids_programs(self):
        cache = self.tree / "cache"
        cache.mkdir()
        mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "noexec", "tmpfs", cache], capture_output=True)
        if mount.returncode != 0:
            self.skipTest("mounting a folder without programs needs root")
        self.addCleanup(subprocess.run, ["umount", cache], check=True)
        self.assert_error(self.render(), 1, "cannot load its code", "XDG_CACHE_HOME")

    def test_a_compiler_that_writes_rubbish_is_tried_again(self):
        rubbish = self.compiler('echo rubbish > "$3"\n')
        self.assert_error(self.render(**rubbish), 1, "cannot load its code")
        self.compiler('exec /usr/bin/c++ "$@"\n')
        self.assertEqual(self.render(**rubbish).returncode, 0)

    def test_a_cache_that_cannot_be_written(self):
        process = self.render(XDG_CACHE_HOME=str(self.shader / "cache"))  # below a file; Mesa, too, says something
        self.assertEqual(process.returncode, 1)
        self.assertRegex(process.stderr, r"(?m)^error: the backend native: .* set XDG_CACHE_HOME to another folder for its code$")

    def test_a_cache_without_room_for_its_code(self):
        self.assertEqual(self.render().returncode, 0)
        for code in (self.tree / "cache/path_tracing_lab").glob("native-*"):
            code.unlink()
            code.mkdir()  # fails at the same moment as a disk that is full
        self.assert_error(self.render(), 1, "cannot be written", "make room there")

    def test_without_embree_the_own_tree_traces_the_rays(self):
        for arguments in ({}, {"LAB_WITHOUT_EMBREE": "1"}):
            self.assertEqual(self.render("--seed=1", f"--output=rays{len(arguments)}.exr", **arguments).returncode, 0)
        own = subprocess.run(
            [self.program, "--list-devices"], capture_output=True, encoding="utf-8", env=os.environ | {"LAB_WITHOUT_EMBREE": "1"}
        ).stdout
        self.assertIn("native's rays: the lab's own tree", own)
        with_embree, without = (read_rgb(self.tree / f"rays{i}.exr") for i in range(2))
        self.assertLess(abs(with_embree - without).mean(), 1e-3 * without.mean())

    def test_a_shader_that_never_ends(self):
        old = "        Hit hit;\n"
        code = self.shader.read_text(encoding="utf-8")
        self.shader.write_text(
            code.replace(old, old + "        while (throughput.x > 0.0) throughput.y += 1.0;\n"), encoding="utf-8"
        )
        process = self.render("--time-limit=1")
        self.assert_error(process, 1, "path_trace.glsl:13: this loop, or one around it, does not end")

    def test_a_crash_keeps_what_was_written(self):
        self.assertEqual(self.render().returncode, 0)
        before = (self.tree / "picture.exr").read_bytes()
        code = self.shader.read_text(encoding="utf-8")
        self.shader.write_text(
            code.replace("return radiance;", "return radiance * float(triangles[seed.x | 0x80000000u].x);"), encoding="utf-8"
        )
        self.assert_error(self.render(), 3, "crashed", "--sanitize")
        self.assertEqual((self.tree / "picture.exr").read_bytes(), before)

    def test_a_crash_keeps_the_last_snapshot(self):
        """One path in a million crashes, after the first samples were saved."""
        code = self.shader.read_text(encoding="utf-8")
        self.shader.write_text(
            code.replace(
                "return radiance;",
                "if (seed.x >> 12 == 77u) radiance *= float(triangles[seed.x | 0x80000000u].x); " "return radiance;",
            ),
            encoding="utf-8",
        )
        self.SIZE = ("--headless", "--width=32", "--height=32", "--samples=4000000000")
        process = self.render("--save-every=0.001")
        self.assert_error(process, 3, "crashed", "the outputs hold")
        self.assertEqual(Exr(self.tree / "picture.exr").text("samples"), re.search(r"hold (\d+) samples", process.stderr)[1])

    def test_a_shader_that_overwrites_or_exhausts_the_stack_still_says_so(self):
        code = self.shader.read_text(encoding="utf-8")
        for size, last in ((4, 1023), (4000000, 4095)):
            with self.subTest(size):
                self.shader.write_text(
                    code.replace(
                        "return radiance;",
                        f"float a[{size}]; a[seed.x & {last}u] = 1.0; " f"return radiance * a[seed.y & {last}u];",
                    ),
                    encoding="utf-8",
                )
                words = ("need more than the stack",) if size > last else ("crashed", "--sanitize")
                self.assert_error(self.render(LAB_LANES="0"), 3, *words)  # lanes ask for each element

    def test_lanes_that_exhaust_the_stack_say_so(self):
        """Each of these arrays is small enough to run in lanes, be they 8 or 16, and all together are larger than the stack."""
        code = self.shader.read_text(encoding="utf-8")
        arrays = "".join(f"float a{i}[15000]; a{i}[seed.x & 4095u] = 1.0; radiance *= a{i}[seed.y & 4095u]; " for i in range(40))
        self.shader.write_text(code.replace("return radiance;", f"{arrays} return radiance;"), encoding="utf-8")
        self.assert_error(self.render(), 3, "need more than the stack")

    def test_errors_of_a_shader_are_those_of_all_backends(self):
        self.shader.write_text(
            self.shader.read_text(encoding="utf-8").replace("vec3 radiance = vec3(0.0);", "vec3 radiance = nothing;"),
            encoding="utf-8",
        )
        native, compute = self.render().stderr, self.render(backend="compute").stderr
        self.assertIn("path_trace.glsl:8: 'nothing' : undeclared identifier", native)
        self.assertEqual(native.splitlines()[0], compute.splitlines()[0])
