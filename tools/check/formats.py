"""The result of a check as autograders read it; see docs/grading."""
import re

PART = {"correct": 1.0, "noisy": 0.5, "expensive": 0.5, "biased": 0.0}  # of a scene's points


def as_gradescope(scenes, hints, points):
    """What Gradescope reads from /autograder/results/results.json: one test with points per scene, with what was found there, and
    the hints as overall output. `scenes` are triples of name, verdict and words; without scenes, the submission has no points."""
    each = points / max(len(scenes), 1)
    tests = [{"name": name, "score": round(each * PART[verdict], 3), "max_score": round(each, 3),
              "status": "passed" if verdict == "correct" else "failed", "output": f"{verdict}: {words}", "visibility": "visible"}
             for name, verdict, words in scenes]
    if not tests:
        tests = [{"name": "check", "score": 0, "max_score": points, "status": "failed", "output": hints[0], "visibility": "visible"}]
    score = round(points * sum(PART[verdict] for _, verdict, _ in scenes) / max(len(scenes), 1), 3)
    return {"score": score, "output": "\n".join(hints), "visibility": "visible", "stdout_visibility": "hidden", "tests": tests}


def escaped(text):
    """Escapes text for a workflow command of GitHub Actions, in which these characters are special."""
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def escaped_property(text):
    """Escapes text for parts of such a command other than its message."""
    return escaped(text).replace(":", "%3A").replace(",", "%2C")


def as_github(verdict, file, line, hints):
    """Workflow commands that show up as annotations of a commit: an error in the file if the shader is not correct."""
    if verdict == "correct":
        return "::notice title=./lab check::correct\n"
    of_compiler = re.search(rf"{re.escape(str(file))}:(\d+):", hints[0]) if hints else None
    line = line or (of_compiler[1] if of_compiler else 1)
    place = f"file={escaped_property(str(file))},line={line}," if file else ""
    return f"::error {place}title=./lab check::{escaped(verdict + ''.join(f'{chr(10)}{hint}' for hint in hints))}\n"
