"""Pictures in Firefox are those of the backend `compute`, pixel by pixel: both draw on Mesa's CPU driver."""

import http.server
import os
import queue
import shutil
import signal
import subprocess
import threading
import unittest

from book_test import Site  # first: it finds the others
import numpy as np
from book import live
from image_files import Exr
from program import BINARIES, ProgramTest
from project import CHAPTERS, course, description, scene_of
from tools_path import PROJECT

FIREFOX, DISPLAY = shutil.which("firefox-esr") or shutil.which("firefox"), shutil.which("xvfb-run")
SETTINGS = {
    "webgl.force-enabled": True,
    "webgl.disabled": False,
    "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "app.update.enabled": False,
    "browser.aboutwelcome.enabled": False,
    "network.captive-portal-service.enabled": False,
}
PAGE = """<!DOCTYPE html><title>films</title><canvas></canvas>""" + "".join(
    f'<script src="/live/{name}"></script>'
    for name in ("sources.js", *live.SCRIPTS[: live.SCRIPTS.index("renderer.js") + 1], "films.js")
)
PATIENCE = 600  # seconds for a chapter
LARGEST_DIFFERENCE = 1e-3  # of the picture's mean
MOST_DIFFERENT = 50 / 65536  # of the pixels: where rounding decides which way a path goes


class Server(http.server.SimpleHTTPRequestHandler):
    def do_GET(self):
        if self.path != "/":
            return super().do_GET()
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        return self.wfile.write(PAGE.encode())

    def do_POST(self):
        self.server.received.put((self.path, self.rfile.read(int(self.headers["Content-Length"]))))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_):
        pass


@unittest.skipUnless(FIREFOX and DISPLAY, "needs Firefox and Xvfb, which ./lab test --all installs")
class Firefox_all(Site, ProgramTest):
    def start(self):
        """Firefox with the page; what it sends arrives in the queue."""
        shutil.copy(PROJECT / "tests/browser/films.js", self.site / "live")
        server = http.server.ThreadingHTTPServer(
            ("127.0.0.1", 0), lambda *arguments: Server(*arguments, directory=str(self.site))
        )
        server.received = queue.Queue()
        threading.Thread(target=server.serve_forever, daemon=True).start()
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        profile = self.folder / "profile"
        profile.mkdir()
        (profile / "user.js").write_text(
            "".join(f'user_pref("{name}", {str(value).lower()});\n' for name, value in SETTINGS.items()), encoding="utf-8"
        )
        browser = subprocess.Popen(
            [DISPLAY, "-a", FIREFOX, "--no-remote", "--profile", profile, f"http://127.0.0.1:{server.server_port}/"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
            env=os.environ | {"HOME": str(self.folder)},
        )
        self.addCleanup(os.killpg, browser.pid, signal.SIGKILL)
        return server.received

    def test_pictures_are_those_of_programs(self):
        received, seen = self.start(), set()
        while (message := received.get(timeout=PATIENCE))[0] != "/done":
            path, body = message
            self.assertNotEqual(path, "/failed", body.decode(errors="replace"))
            _, _, chapter, name, size = path.split("/")
            width, height = map(int, size.split("x"))
            file = self.folder / f"{chapter}.exr"
            # Camera paths without light paths are those of the chapter before.
            program = description(chapter)["continues"] if description(chapter).get("light_paths") else chapter
            subprocess.run(
                list(
                    map(
                        str,
                        (
                            BINARIES / program,
                            scene_of(name),
                            "--width",
                            width,
                            "--height",
                            height,
                            "--samples",
                            16,
                            "--max-path-length",
                            name.rpartition("_")[2],
                            "--backend",
                            "compute",
                            "--quiet",
                            "--headless",
                            "--output",
                            file,
                        ),
                    )
                ),
                check=True,
            )
            expected = np.array(Exr(file).pixels()).reshape(3, -1).T
            pixels = np.frombuffer(body, dtype="<f4").reshape(-1, 3)
            different = (np.abs(pixels - expected).max(axis=1) > LARGEST_DIFFERENCE * expected.mean()).sum()
            print(
                f"{chapter}: {different} of {len(pixels)} pixels differ, means by {abs(pixels.mean() / expected.mean() - 1):.1g}"
            )
            with self.subTest(chapter=chapter):
                self.assertLessEqual(different, MOST_DIFFERENT * len(pixels))
            seen.add(chapter)
        self.assertEqual(seen, {CHAPTERS[number] for number in course()})
