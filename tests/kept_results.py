"""The last result of each test, kept in the build folder: so ./lab test --all goes on where it was interrupted, and does again only what a
change can touch."""
import hashlib
import json
import re
import time

from project import ROOT, commit, run_program

# As ctest tells the end of a test: its name, what became of it, and its seconds.
ENDED = re.compile(r"\s*\d+/\d+ Test +#\d+: (\S+) \.*[ *]*(\w.*?) +([\d.]+) sec\s*$")
# What programs of tests in C++ are made of and read, and those that plant mistakes. Other tests may read any file.
IN_CPP = re.compile(r"(unit|shaders|convergence|parity|hard_cases|viewer|mistakes)\.")
READ_IN_CPP = re.compile(r"(CMake[^/]*|(assets|common|shaders|chapters)/.*(?<!\.md)|tests/(?!cli/).*(?<!\.py))$")
READ_BY_MISTAKES = re.compile(rf"{READ_IN_CPP.pattern}|(tests/.*|tools/.*)\.py$")


def files():
    """Path -> digest of every file that git tracks or would track. Outside a repository nobody knows: no two calls agree."""
    try:
        listed = run_program(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"])
    except OSError:
        return {"unknown": time.time()}
    paths = [path for path in sorted(set(listed.stdout.split("\0"))) if path and (ROOT / path).is_file()]
    return {path: hashlib.sha256((ROOT / path).read_bytes()).hexdigest() for path in paths} or {"unknown": time.time()}


class KeptResults:
    def __init__(self, file):
        self.file, self.commit, found = file, commit(), files()
        self.digests = {
            kind: hashlib.sha256(repr([item for item in found.items() if not read or read.match(item[0])]).encode()).hexdigest()
            for kind, read in (("cpp", READ_IN_CPP), ("mistakes", READ_BY_MISTAKES), ("other", None))
        }
        lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
        self.results = {row["test"]: row for row in map(json.loads, lines)}  # the last one of a test counts

    def sources(self, test):
        """The digest of all that a test may depend on."""
        kind = "mistakes" if test.startswith("mistakes.") else "cpp" if IN_CPP.match(test) else "other"
        return self.digests[kind]

    def note(self, test, result, seconds):
        """Keeps a result at once: ctest may be interrupted."""
        row = {"test": test, "result": result, "seconds": seconds, "commit": self.commit, "sources": self.sources(test)}
        self.results[test] = row
        with self.file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")

    def state(self, test):
        """ "green", "red", "skipped" if this machine cannot run it, "old" if sources have changed since, or "never run"."""
        row = self.results.get(test)
        return "never run" if not row else "old" if row["sources"] != self.sources(test) else row["result"]

    def tell(self, tests):
        """Prints how these tests stand."""
        states = {}
        for test in tests:
            states.setdefault(self.state(test), []).append(test)
        print(", ".join(f"{len(those)} {state}" for state, those in sorted(states.items())))
        for state in ("red", "skipped"):
            for test in states.get(state, []):
                print(f"  {state}: {test}")
        known = [self.results[test]["seconds"] for test in tests if test in self.results]
        print(f"the last runs of {len(known)} of {len(tests)} took {sum(known) / 3600:.1f} hours, one after another")


def outcome(words):
    """Green, red or skipped, from what ctest says of a test."""
    return "green" if words == "Passed" else "skipped" if words.startswith(("Skipped", "Not Run (Disabled)")) else "red"
