"""The result of a check as autograders read it; see docs/grading."""
import re

PART = {"correct": 1.0, "noisy": 0.5, "expensive": 0.5, "biased": 0.0}  # of a scene's points


def as_gradescope(scenes, hints, points, passed_anyway=(), is_unfinished=False):
    """What Gradescope reads from /autograder/results/results.json: one test per scene, with what was found there, and the hints as
    overall output. `scenes` are triples of name, verdict and words; without scenes, the submission has no points. Those in
    `passed_anyway` say nothing about the exercise, since its placeholder passes them: if they fail, all others lose a part of their points.
    """
    if not scenes:
        return submission(0, hints, [a_test("check", False, 0, points, hints[0])])
    each = points / max(sum(name not in passed_anyway for name, _, _ in scenes), 1)
    kept = (
        0 if is_unfinished else 1 - sum(1 - PART[verdict] for name, verdict, _ in scenes if name in passed_anyway) / len(scenes)
    )
    tests, score = [], 0
    for name, verdict, words in scenes:
        most = 0 if name in passed_anyway else each
        score += most * PART[verdict] * kept
        tests.append(
            a_test(name, verdict == "correct" and not is_unfinished, most * PART[verdict] * kept, most, f"{verdict}: {words}")
        )
    return submission(score, hints, tests)


def a_test(name, is_passed, score, most, words):
    return {
        "name": name,
        "score": round(score, 3),
        "max_score": round(most, 3),
        "status": "passed" if is_passed else "failed",
        "output": words,
        "visibility": "visible",
    }


def submission(score, hints, tests):
    return {
        "score": round(score, 3),
        "output": "\n".join(hints),
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "tests": tests,
    }


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
    return f"::error {place}title=./lab check::{escaped(chr(10).join(hints))}\n"
