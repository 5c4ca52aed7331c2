"""Programs of chapters that render one picture after another: starting one takes longer than a tiny picture."""
import os
import subprocess
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from project import ROOT, UserError, printable, show_progress

POLLING = 0.5  # seconds
STARVED = 10  # times its limit that a program may take if other programs keep it from computing for as long
JOBS = 2  # programs at a time: while one prepares a picture, another renders


def run_all(what, function, items, jobs):
    """Calls a function, which uses a Batch, for all items, `jobs` at a time, with progress. After an error the others go on; after
    Ctrl-C those that have begun come to their end."""
    if jobs > 1:  # Mesa's driver for CPUs would start as many threads in each program as there are cores
        os.environ["LP_NUM_THREADS"] = str(max(os.cpu_count() // (jobs * JOBS), 1))
    started = time.monotonic()
    with ThreadPoolExecutor(jobs) as threads:
        calls = [threads.submit(function, item) for item in items]
        try:
            for done, _ in enumerate(as_completed(calls), 1):
                show_progress(what, done, len(items), started)
        except KeyboardInterrupt:
            threads.shutdown(wait=False, cancel_futures=True)
            raise
    for call in calls:
        call.result()


def quoted(argument):
    """An argument as it stands in a line for --batch."""
    escaped = str(argument).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def cpu_seconds(process):
    """What a running process has computed for so far, in all its threads; None where the system does not say."""
    try:
        fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def is_crowded():
    """Whether programs wait for a core."""
    return os.name == "posix" and os.getloadavg()[0] > os.cpu_count()


class Worker:
    """A program that waits for command lines."""

    def __init__(self, program):
        self.program = program
        self.errors = tempfile.TemporaryFile()  # nobody reads a pipe meanwhile, so it could fill up
        self.process = subprocess.Popen(
            [*program, "--batch"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.errors,
            cwd=ROOT,
            start_new_session=True,
        )
        self.count = 0  # lines so far

    def run(self, arguments, timeout):
        is_late, has_ended = threading.Event(), threading.Event()

        def watch():
            started, before = time.monotonic(), cpu_seconds(self.process)
            while not has_ended.wait(min(timeout, POLLING)):
                elapsed, now = time.monotonic() - started, cpu_seconds(self.process)
                is_starved = None not in (before, now) and now - before < timeout and is_crowded()
                if elapsed >= (STARVED if is_starved else 1) * timeout:
                    is_late.set()
                    self.process.kill()
                    return

        watching = threading.Thread(target=watch if timeout else lambda: None, daemon=True)
        watching.start()
        self.count += 1
        try:
            self.process.stdin.write(os.fsencode(" ".join(map(quoted, arguments)) + "\n"))
            self.process.stdin.flush()
            is_done = bool(self.process.stdout.readline())
        except OSError:  # it has ended before
            is_done = False
        has_ended.set()
        watching.join()
        code = 0 if is_done else self.process.wait()
        if is_late.is_set():
            raise subprocess.TimeoutExpired(self.program, timeout)
        self.errors.seek(0)
        errors = printable(self.errors.read()).replace(f"line {self.count} of the standard input: ", "")
        return subprocess.CompletedProcess([*self.program, *arguments], code, "", errors)

    def end(self, is_idle):
        """If it is idle, it still saves what it has compiled."""
        self.process.stdin.close() if is_idle else self.process.kill()
        self.process.wait()

    def close(self):
        for file in (self.process.stdout, self.errors):
            file.close()
        try:
            self.process.stdin.close()
        except OSError:  # what it holds goes nowhere
            pass


class Batch:
    """Runs programs like run_program(), but keeps each for further pictures, and calls functions that do so in several threads. At
    the end of a `with` block everything ends, even programs that are still rendering."""

    def __init__(self):
        self.lock, self.is_open, self.workers, self.idle = threading.Lock(), True, [], []
        self.threads = ThreadPoolExecutor(JOBS)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        with self.lock:
            self.is_open = False
            for worker in self.workers:
                worker.end(worker in self.idle)
        self.threads.shutdown(cancel_futures=True)  # they may still read from what has ended
        for worker in self.workers:
            worker.close()

    def map(self, function, items):
        """The results of a function for all items, in their order."""
        return self.threads.map(function, items)

    def run(self, program, arguments, timeout=None):
        """Exit code and error of a run of a program, given as a list, with these arguments. Raises subprocess.TimeoutExpired after
        `timeout` seconds."""
        program = list(map(str, program))
        worker = self.take(program)
        process = worker.run(arguments, timeout)
        if process.returncode == 0:
            self.idle.append(worker)
        return process

    def take(self, program):
        with self.lock:
            if not self.is_open:
                raise UserError("ended")
            worker = next((worker for worker in self.idle if worker.program == program), None)
            if worker:
                self.idle.remove(worker)
            else:
                self.workers.append(worker := Worker(program))
            return worker
