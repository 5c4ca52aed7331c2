#!/usr/bin/env python3
"""Runs a mix of commands in programs that sanitizers watch, and fails where one of them complains.

    python3 tests/sanitizers/commands.py asan    AddressSanitizer and UndefinedBehaviorSanitizer
    python3 tests/sanitizers/commands.py tsan    ThreadSanitizer
Builds the preset of this name first.
"""

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COMPLAINT = re.compile("Sanitizer|runtime error:")
OPTIONS = {
    "ASAN_OPTIONS": "detect_leaks=0",  # the search for leaks itself crashes now and then, at a program's end
    "UBSAN_OPTIONS": "print_stacktrace=1",
    "TSAN_OPTIONS": f"suppressions={ROOT}/tests/sanitizers/threads.txt",
    "GALLIVM_PERF": "nopt",
}  # Mesa's driver for CPUs takes longer to optimise a shader than to run it
VIEWS = ("normals", "depth", "albedo", "emission", "focus", "texture-coordinates", "triangles", "instances", "bvh-steps")
RENDERS = """--backend=auto cornell_box
    --backend=compute cornell_box --specular --background=1,1,1 --seed=7
    --backend=pipeline torus
    --backend=query torus --view=idle-lanes
    --backend=native torus --max-path-length=3 --only-path-length=2
    --sanitize torus
    --backend=native sunny --output=a.hdr --output=a.png --output=a.jpg --exposure=1
    --backend=native cornell_box --report=a.csv --target-error=0.5
    --backend=native cornell_box --samples=100000 --time-limit=1 --save-every=0.1
    --backend=compute cornell_box --output=part.exr
    --backend=compute cornell_box --resume=part.exr --samples=5
    --backend=native cornell_box --reference=part.exr --report=a.json --quiet
    --debug-pixel=0,0 torus
    --debug-pixel=1599,1599 torus --width=1600 --height=1600""".split(
    "\n"
)


class Mix:
    def __init__(self, programs):
        self.programs, self.folder, self.complaints = programs, tempfile.TemporaryDirectory(), 0

    def run(self, name, *arguments, lines="", stop=None, codes=(0,)):
        """Runs a program with these lines as its standard input. Sends the signal `stop` once it has written stopped.exr."""
        stopped = Path(self.folder.name) / "stopped.exr"
        stopped.unlink(missing_ok=True)
        with subprocess.Popen(
            [self.programs / name, *arguments],
            cwd=self.folder.name,
            env=os.environ | OPTIONS,
            text=True,
            errors="replace",
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        ) as process:
            if stop:
                while not stopped.exists() and process.poll() is None:
                    time.sleep(0.01)
                process.send_signal(stop)
            try:
                output = process.communicate(lines, timeout=600)[0]
            except subprocess.TimeoutExpired:
                process.kill()
                output = "Sanitizer: nothing ended it after 600 s\n" + process.communicate()[0]
        if process.returncode in codes and not COMPLAINT.search(output):
            return print("ok   ", name, *arguments, flush=True)
        self.complaints += 1
        print("WRONG", name, *arguments, f"\n{lines}\n{output}\nexit code {process.returncode}", flush=True)

    def run_all(self):
        chapter, words = "10_path_regeneration", "--width=24 --height=20 --samples=3 --output=a.exr"
        tiny = words.split()
        for path in sorted((ROOT / "chapters").glob("[0-9]*")):
            self.run(path.name, "--batch", lines="".join(f"{words} --backend={name}\n" for name in ("native", "compute")))
        for line in RENDERS:
            defaults = [option for option in tiny if option.split("=")[0] not in line]
            self.run(chapter, "--headless", *defaults, *line.split())
        for backend, views in (("compute", VIEWS), ("native", VIEWS[:-1])):  # which lacks the last one
            self.run(chapter, "--batch", lines="".join(f"{words} torus --view={view} --backend={backend}\n" for view in views))
            for number in (signal.SIGINT, signal.SIGHUP):
                self.run(
                    chapter,
                    "--headless",
                    "cornell_box",
                    "--samples=4000000000",
                    f"--backend={backend}",
                    "--save-every=0.1",
                    "--output=stopped.exr",
                    stop=number,
                )
        self.run("merge_images", "part.exr", "part.exr", "-o", "twice.exr", codes=(1,))
        self.run(chapter, "--list-devices")
        for wrong in ("nowhere", "--samples=0", "--resume=/dev/null"):
            self.run(chapter, "--headless", wrong, codes=(1,))
        for kind, arguments in (("exr", ["cornell_box", "--resume=cut.exr"]), ("obj", ["cut.obj"]), ("scene", ["cut.json"])):
            for seed in sorted((ROOT / "tests/fuzz/seeds" / kind).iterdir()):
                file = Path(self.folder.name) / f"cut{seed.suffix}"
                file.write_bytes(seed.read_bytes()[: seed.stat().st_size * 2 // 3])
                self.run(chapter, "--headless", "--backend=native", *tiny, *arguments, codes=(0, 1))


def main():
    [preset] = sys.argv[1:]
    if preset == "tsan":  # which does not see how Embree's threads wait for each other
        OPTIONS["LAB_WITHOUT_EMBREE"] = "1"
    for step in (["--preset", preset, "-DLAB_TESTS=OFF"], ["--build", "--preset", preset]):
        subprocess.run(["cmake", *step], cwd=ROOT, check=True)
    mix = Mix(ROOT / f"build-{preset}/bin")
    mix.run_all()
    print(f"{mix.complaints} complaints")
    sys.exit(mix.complaints > 0)


if __name__ == "__main__":
    main()
