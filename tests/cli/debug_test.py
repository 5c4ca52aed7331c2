"""./lab debug and its page: the searches of docs/debugging.md find what they claim."""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from unittest import mock

from program import BINARIES, PROJECT, ProgramTest, copy_project  # first: it finds the tools
from image_files import Exr
from check import command as check_command
from debug import command
from project import CHAPTERS
from references.images import read_rgb

PAGE = (PROJECT / "docs/debugging.md").read_text(encoding="utf-8")
SHADER = "chapters/01_uniform_sampling/path_trace.glsl"


class CopiedLab:
    """A copy of the lab with its own shaders and the program of chapter 1."""
    SIZE = ("--headless", "--width=32", "--height=32", "--samples=2")

    def setUp(self):
        super().setUp()
        program = BINARIES / CHAPTERS[1]
        devices = subprocess.run([program, "--list-devices"], capture_output=True, encoding="utf-8").stdout
        if not re.search(r"native +works", devices):
            self.skipTest("no device has the backend native")
        self.tree = self.folder / "lab"
        self.program = copy_project(self.tree, program=program)
        self.shader = self.tree / SHADER

    def plant(self, text):
        """Makes the replacements that a text of the page asks for, starting from the original shader."""
        code = (PROJECT / SHADER).read_text(encoding="utf-8")
        for old, new in re.findall(r"replace\s+`([^`]+)`\s+by\s+`([^`]+)`", text):
            self.assertEqual(code.count(old), 1, old)
            code = code.replace(old, new)
        self.shader.write_text(code, encoding="utf-8")

    def execute(self, *words):
        return subprocess.run(list(map(str, words)), cwd=self.tree, capture_output=True, encoding="utf-8", timeout=300, stdin=subprocess.DEVNULL,
                              env=os.environ | {"LAB_BINARIES": str(self.tree / "build/bin")})

    def debug(self, *words):
        if not shutil.which("gdb"):
            self.skipTest("gdb is not installed")
        return self.execute(sys.executable, "-B", "tools", "debug", *words).stdout


    def render(self, *arguments, backend="native", **environment):
        return subprocess.run([self.program, *self.SIZE, f"--backend={backend}", "--output=picture.exr", *arguments], cwd=self.tree, capture_output=True, encoding="utf-8", timeout=120,
                              env=os.environ | {"XDG_CACHE_HOME": str(self.tree / "cache")} | environment)

    def compiler(self, script):
        path = self.tree / "fake/c++"
        path.parent.mkdir(exist_ok=True)
        path.write_text("#!/bin/sh\n" + script, encoding="utf-8")
        path.chmod(0o755)
        return {"PATH": f"{path.parent}:{os.environ['PATH']}"}


class DebuggerStops_all(ProgramTest):
    """In each chapter, ./lab debug stops where a path begins."""

    def test_in_every_chapter(self):
        if not shutil.which("gdb"):
            self.skipTest("gdb is not installed")
        for number in CHAPTERS:
            with self.subTest(chapter=number):
                output = subprocess.run([sys.executable, "-B", "tools", "debug", str(number), "--pixel=9,9", "--width=32", "--height=32",
                                         "--", "-batch", "-ex", "bt 1"], cwd=PROJECT, capture_output=True, encoding="utf-8", timeout=600,
                                        stdin=subprocess.DEVNULL).stdout
                self.assertRegex(output, r"(?m)^#0 .*(path_trace|extend_path) \(this=")


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
            checksum = 0xcbf29ce484222325
            for byte in chosen:
                checksum = (checksum ^ byte) * 0x100000001b3 % 2**64
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
                with self.start(*self.SIZE, "--backend=native", environment=environment, program=self.program, prepare=os.setsid) as process:
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
            with self.start(*self.SIZE, "--backend=native", environment=environment, program=self.program,
                            prepare=let_the_compiler_run_first) as process:
                process.communicate(timeout=300)
            self.assertEqual(process.returncode, -signal.SIGTERM)


class LanesTest(CopiedLab, ProgramTest):
    """How many paths run at once is said, with the reason if it is one."""

    def test_one_variable_turns_lanes_off(self):
        cpu = Path("/proc/cpuinfo").read_text(encoding="utf-8")
        if " avx2 " not in cpu:
            self.skipTest("the CPU lacks AVX2")
        for how, arguments, environment in ((f"{16 if ' avx512dq ' in cpu else 8} paths at a time", [], {}),
                                            ("8 paths at a time", [], {"LAB_LANES": "8"}), ("1 path at a time: LAB_LANES=0", [], {"LAB_LANES": "0"}),
                                            ("1 path at a time: --sanitize", ["--sanitize"], {})):
            self.assertIn(f"\neach core      traces {how}\n", self.render(*arguments, **environment).stdout)


class DebugTest(CopiedLab, ProgramTest):
    def search(self, title):
        """A section of the page with its blocks: the command, gdb's input, and the output to expect."""
        section = re.search(rf"^## {title}.*?(?=^## )", PAGE, re.MULTILINE | re.DOTALL)[0]
        blocks = dict(re.findall(r"^```(\w+)\n(.*?)^```", section, re.MULTILINE | re.DOTALL))
        self.plant(section)
        words = re.search(r"^    \./lab (.*)$", section, re.MULTILINE)[1].split()
        self.assertEqual(words[1], "30", "the copy of chapter 1, for which chapter 1 stands here")
        return [words[0], "1", *words[2:]], blocks

    def assert_found(self, seen, blocks):
        at = 0
        for line in blocks["text"].splitlines():
            self.assertIn(line, seen[at:])
            at = seen.index(line, at) + len(line)

    def test_the_searches_of_the_page(self):
        for title in ("A breakpoint", "A watchpoint"):
            with self.subTest(title):
                words, blocks = self.search(title)
                commands = [word for line in blocks["gdb"].splitlines() for word in ("-ex", line)]
                self.assert_found(self.debug(*words[1:], "--", "-batch", *commands), blocks)
        with self.subTest("A sanitizer"):
            words, blocks = self.search("A sanitizer")
            process = self.execute(self.program, *words[2:])
            self.assert_found(process.stderr, blocks)
            self.assertEqual(process.returncode, 3)
        with self.subTest("Nothing is wrong"):
            self.plant("")
            self.assertEqual(self.execute(self.program, *words[2:], "--quiet").stderr, "")

    def test_it_stops_in_the_student_s_file_with_its_variables(self):
        seen = self.debug(1, "--pixel", "20,30", "--width", 40, "--height", 40, "--sample", 3, "--", "-batch", "-ex", "info locals",
                          "-ex", "up", "-ex", "print first", "-ex", "continue")
        self.assertIn(f"{SHADER}:8", seen)
        self.assertRegex(seen, r"throughput = \(.*, .*, .*\)")
        self.assertRegex(seen, r"pixel +20,30 sample 3: ")

    def test_it_prints_what_the_picture_has_in_this_pixel(self):
        size = ["--headless", "--width=1600", "--height=1600", "--samples=1"]  # so large that freed memory is gone
        self.assertEqual(self.execute(self.program, *size, "--backend=native", "--output=picture.exr").returncode, 0)
        picture = read_rgb(self.tree / "picture.exr")
        brightest = divmod(int(picture.sum(axis=2).argmax()), 1600)
        self.assertGreater(picture[brightest].max(), 0)
        for y, x in ((0, 0), brightest):
            process = self.execute(self.program, *size, f"--debug-pixel={x},{y}")
            expected = " ".join(f"{value:g}" for value in picture[y, x])
            self.assertIn(f"\npixel          {x},{y} sample 0: {expected}\n", process.stdout, process.returncode)

    def test_visual_studio_code(self):
        process = self.execute(sys.executable, "-B", "tools", "debug", "--vscode")
        self.assertEqual(process.stdout.split(), [".vscode/launch.json", ".vscode/tasks.json"])
        launch = json.loads((self.tree / ".vscode/launch.json").read_text(encoding="utf-8"))
        [configuration] = launch["configurations"]
        inputs = {found["id"] for found in launch["inputs"]}
        self.assertEqual(set(re.findall(r"\$\{input:(\w+)\}", json.dumps(configuration))), inputs)
        # Running it again is fine, and foreign files are kept.
        self.assertEqual(self.execute(sys.executable, "-B", "tools", "debug", "--vscode").returncode, 0)
        (self.tree / ".vscode/launch.json").write_text("{}", encoding="utf-8")
        refused = self.execute(sys.executable, "-B", "tools", "debug", "--vscode")
        self.assertIn("launch.json is there already", refused.stderr)

    def test_refusals(self):
        self.assert_tool_refused(["debug"], "which chapter")
        self.assert_tool_refused(["debug", 99], "no chapter 99")
        self.assert_refused(["--debug-pixel", "64,3", "--width=64", "--height=64"], "64,3", "64x64")
        self.assert_refused(["--sanitize", "--backend=compute"], "--backend compute")

    def test_lldb_stops_at_the_same_place(self):
        self.assertEqual(command.command_for("lldb", "program", ["a"], []),
                         ["lldb", "-o", "breakpoint set --name path_trace", "-o", "process launch", "--", "program", "a"])


class NativeFailures_all(CopiedLab, ProgramTest):
    """What can go wrong when shaders are compiled into programs."""
    def assert_error(self, process, code, *words):
        self.assertEqual(process.returncode, code, process.stderr)
        self.assertEqual(process.stderr.count("\n"), 1, process.stderr)
        for word in words:
            self.assertIn(word, process.stderr)

    def test_without_a_compiler(self):
        self.assert_error(self.render(PATH=str(self.tree)), 2, "a C++ compiler", "these work on it", "compute")
        process = subprocess.run([self.program, "--list-devices"], capture_output=True, encoding="utf-8", env=os.environ | {"PATH": ""})
        self.assertRegex(process.stdout, r"native +lacks a C\+\+ compiler")

    def test_submissions_stay_in_the_driver(self):
        self.assert_error(self.render(LAB_WITHOUT_NATIVE="1"), 2, "LAB_WITHOUT_NATIVE")
        for backend, wanted in (("auto", "1"), ("native", None)):
            with (mock.patch.dict(os.environ), mock.patch.object(sys, "argv", ["check", "1", "--backend", backend]),
                  mock.patch.object(check_command, "check", side_effect=SystemExit(0))):
                os.environ.pop("LAB_WITHOUT_NATIVE", None)
                with self.assertRaises(SystemExit):
                    check_command.main()
                self.assertEqual(os.environ.get("LAB_WITHOUT_NATIVE"), wanted)

    def test_a_compiler_that_fails(self):
        self.assert_error(self.render(**self.compiler("echo broken; exit 1\n")), 1, "does not compile", "broken", "--backend compute")
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
        own = subprocess.run([self.program, "--list-devices"], capture_output=True, encoding="utf-8",
                             env=os.environ | {"LAB_WITHOUT_EMBREE": "1"}).stdout
        self.assertIn("native's rays: the lab's own tree", own)
        with_embree, without = (read_rgb(self.tree / f"rays{i}.exr") for i in range(2))
        self.assertLess(abs(with_embree - without).mean(), 1e-3 * without.mean())

    def test_a_shader_that_never_ends(self):
        old = "        Hit hit;\n"
        code = self.shader.read_text(encoding="utf-8")
        self.shader.write_text(code.replace(old, old + "        while (throughput.x > 0.0) throughput.y += 1.0;\n"), encoding="utf-8")
        process = self.render("--time-limit=1")
        self.assert_error(process, 1, "path_trace.glsl:13: this loop, or one around it, does not end")

    def test_a_crash_keeps_what_was_written(self):
        self.assertEqual(self.render().returncode, 0)
        before = (self.tree / "picture.exr").read_bytes()
        code = self.shader.read_text(encoding="utf-8")
        self.shader.write_text(code.replace(
            "return radiance;", "return radiance * float(triangles[seed.x | 0x80000000u].x);"), encoding="utf-8")
        self.assert_error(self.render(), 3, "crashed", "--sanitize")
        self.assertEqual((self.tree / "picture.exr").read_bytes(), before)

    def test_a_crash_keeps_the_last_snapshot(self):
        """One path in a million crashes, after the first samples were saved."""
        code = self.shader.read_text(encoding="utf-8")
        self.shader.write_text(code.replace("return radiance;", "if (seed.x >> 12 == 77u) radiance *= float(triangles[seed.x | 0x80000000u].x); "
                                            "return radiance;"), encoding="utf-8")
        self.SIZE = ("--headless", "--width=32", "--height=32", "--samples=4000000000")
        process = self.render("--save-every=0.001")
        self.assert_error(process, 3, "crashed", "the outputs hold")
        self.assertEqual(Exr(self.tree / "picture.exr").text("samples"), re.search(r"hold (\d+) samples", process.stderr)[1])

    def test_a_shader_that_overwrites_or_exhausts_the_stack_still_says_so(self):
        code = self.shader.read_text(encoding="utf-8")
        for size, last in ((4, 1023), (4000000, 4095)):
            with self.subTest(size):
                self.shader.write_text(code.replace("return radiance;", f"float a[{size}]; a[seed.x & {last}u] = 1.0; "
                                                    f"return radiance * a[seed.y & {last}u];"), encoding="utf-8")
                words = ("need more than the stack",) if size > last else ("crashed", "--sanitize")
                self.assert_error(self.render(LAB_LANES="0"), 3, *words)  # lanes ask for each element

    def test_lanes_that_exhaust_the_stack_say_so(self):
        """Each of these arrays is small enough to run in lanes, be they 8 or 16, and all together are larger than the stack."""
        code = self.shader.read_text(encoding="utf-8")
        arrays = "".join(f"float a{i}[15000]; a{i}[seed.x & 4095u] = 1.0; radiance *= a{i}[seed.y & 4095u]; " for i in range(40))
        self.shader.write_text(code.replace("return radiance;", f"{arrays} return radiance;"), encoding="utf-8")
        self.assert_error(self.render(), 3, "need more than the stack")

    def test_errors_of_a_shader_are_those_of_all_backends(self):
        self.shader.write_text(self.shader.read_text(encoding="utf-8").replace("vec3 radiance = vec3(0.0);", "vec3 radiance = nothing;"),
                               encoding="utf-8")
        native, compute = self.render().stderr, self.render(backend="compute").stderr
        self.assertIn("path_trace.glsl:8: 'nothing' : undeclared identifier", native)
        self.assertEqual(native.splitlines()[0], compute.splitlines()[0])
