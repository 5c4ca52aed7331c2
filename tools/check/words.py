"""What a check reports about a shader, in words: a list of lines, each with a head, and the page that they make."""
import os
import shutil
import sys
import textwrap

from check.grading import TOO_MUCH, early_bias
from project import CHAPTERS

MOST_QUESTIONS, MOST_FACTS = 2, 5
FAR_NOISIER = 3  # times the smallest bias that shows elsewhere: a scene that is told by its name
MARGIN = 15  # columns of the heads
COLOURS = {"correct": 32, "biased": 31, "unfinished": 33, "noisy": 33, "expensive": 33}  # of a terminal
SIMILAR = "no common mistake fits all facts; what follows is similar, but may be wrong"
NOTHING_SEEN = "no experiment finds what is wrong: the picture of the differences shows where it is"


def percent(value):
    return f"{100 * value:+.2g} %" if abs(value) < 0.1 else f"{100 * value:+.0f} %"


def tell_early(cases):
    """What is certain after the first runs: a part of the progress."""
    scene, value = early_bias(cases)
    if scene:
        words = f"{scene} is too {'bright' if value > 0 else 'dark'} ({percent(value)})"
    else:
        words = f"no picture is wrong by {100 * value:.2g} % or more in its mean" if value < 1 else "nothing is sure yet"
    start = "\r\033[K" if sys.stderr.isatty() else ""  # over the bar
    print(f"{start}{'so far':{MARGIN}}{words}; smaller differences take all renders", file=sys.stderr, flush=True)


def scene_words(scene):
    """The findings in a scene, as a list of words."""
    worst = max(scene["image"], key=lambda test: abs(test["value"]))
    biased = [tile for tile in scene["tiles"] if tile["is_biased"]]
    words = [f"mean {' '.join(percent(test['value']) for test in scene['image'])} (red, green, blue)"]
    if any(test["is_biased"] for test in scene["image"]):
        words.append("too bright" if worst["value"] > 0 else "too dark")
    if biased:
        words.append(f"{len(biased)} of {len(scene['tiles'])} tiles differ")
    if scene["invalid_samples"]:
        words.append(f"{scene['invalid_samples']} samples infinite or not a number")
    if scene["verdict"] != "biased":
        least = max(test["detectable"] for test in scene["image"])
        if least < 1:  # few runs of a noisy scene tell nothing
            words.append(f"a bias from {100 * least:.2g} % would have shown")
        if scene["noise"][0] is not None:
            limit = f", where {scene['most_noise']:.2f} is the limit" if scene["verdict"] == "noisy" else ""
            words.append(
                f"{scene['noise'][0]:.2f} times the noise of the chapter's own shader (95 % interval "
                f"{scene['noise'][1]:.2f} to {scene['noise'][2]:.2f}{limit})"
            )
        words.append(f"{scene['rays']:.2f} times its rays")
    return words


def worst_scene(result):
    """What is wrong in the scene with the verdict, in a few words; experiments may have found what no scene shows."""
    scene = next((scene for scene in result["scenes"] if scene["verdict"] == result["verdict"]), None)
    if not scene and result["verdict"] == "noisy":
        subject, noise = result["diagnosis"]["too_noisy"]
        return noise_words(subject, f"{noise:.2g} times the variance", TOO_MUCH)
    if not scene:
        return "no picture shows a bias, but experiments do"
    if result["verdict"] == "biased":
        worst = max(
            (test["value"] for test in [*scene["image"], *(tile for tile in scene["tiles"] if tile["is_biased"])]), key=abs
        )
        if not abs(worst) < 1e6:  # also if it is no number
            return f"{scene['scene']} has values that no light has: is a variable used before it is set?"
        if worst < -1:
            return f"{scene['scene']} has negative light: is a cosine below 0?"
        return f"{scene['scene']} is too {'bright' if worst > 0 else 'dark'} (by up to {percent(worst)})"
    if result["verdict"] == "noisy":
        return noise_words(scene["scene"], f"{scene['noise'][0]:.2f} times the noise", scene["most_noise"])
    if result["verdict"] == "expensive":
        return f"{scene['scene']} takes {scene['rays']:.2f} times the rays of the chapter's own shader"
    return f"nothing differs{smallest_bias(result['scenes'])}"


def noise_words(what, noise, limit):
    return f"the mean is right, but {what} has {noise} of the chapter's own shader, and {limit:.2f} is the limit"


def smallest_bias(scenes):
    """What would have shown, in words: in the noisiest scene it may be far more than elsewhere."""
    least = sorted((max(test["detectable"] for test in scene["image"]), scene["scene"]) for scene in scenes if scene["image"])
    if not least:
        return ""
    *others, (worst, name) = least
    if others and worst > FAR_NOISIER * others[-1][0]:
        return f"; a bias from {100 * others[-1][0]:.2g} % would have shown, or {100 * worst:.2g} % in {name}"
    return f", and a bias from {100 * worst:.2g} % would have shown"


def questions(result):
    """The questions that lead to what may be wrong, if few mistakes can cause it."""
    mistakes = (result["diagnosis"] or {"mistakes": []})["mistakes"] if result["verdict"] != "correct" else []
    return (
        [": ".join(filter(None, (mistake.get("name"), mistake["hint"]))) for mistake in mistakes]
        if len(mistakes) <= MOST_QUESTIONS
        else []
    )


def headline(result):
    """The verdict, and the question that leads to the mistake or else what is wrong most."""
    if result["unfinished_line"]:
        return "unfinished", f"{result['unfinished_file']}:{result['unfinished_line']} says TODO"
    is_asked = questions(result) and result["diagnosis"]["fits"]
    return result["verdict"], questions(result)[0] if is_asked else worst_scene(result)


def hint_lines(result):
    """Pairs of a word and a lead to the mistake: what the experiments have shown, other questions than the headline's, what to read."""
    lines, found = [], result["diagnosis"]
    if result["unfinished_line"] or result["verdict"] == "correct" or not found:
        return lines
    asked, mistakes = questions(result), found["mistakes"]
    if result["verdict"] == "noisy" and found["fits"] and asked:  # where the headline is a question
        lines.append(("seen", worst_scene(result)))
    lines += [("seen", fact["text"]) for fact in found["facts"][:MOST_FACTS]] or [("seen", NOTHING_SEEN)]
    if len(found["facts"]) > MOST_FACTS:
        lines.append(("seen", f"and {len(found['facts']) - MOST_FACTS} more things"))
    if mistakes and not found["fits"]:
        lines += [("not sure", SIMILAR), *(("maybe", question) for question in asked)]
    else:
        lines += [("or", question) for question in asked[1:]]
    if asked:
        slides, sections = (
            "; ".join(dict.fromkeys(mistake[key] for mistake in mistakes if mistake[key])) for key in ("slide", "section")
        )
        page = f"chapters/{CHAPTERS[result['chapter']]}/README.md"
        lines.append(
            ("read again", (f"{slides} (docs/slides.md), " if slides else "") + page + (f": {sections}" if sections else ""))
        )
    if len(mistakes) > 1 and found["fits"]:
        lines.append(("not sure", f"{len(mistakes)} common mistakes show the same in all experiments"))
    if found["next"] and not (found["fits"] and len(mistakes) == 1):
        lines.append(("next", found["next"]))
    return lines


def hints_of(result):
    """What a platform shows of a shader that is not correct: texts, the headline first."""
    return [
        f"{head}: {text}" for head, text in ([headline(result), *hint_lines(result)] if result["verdict"] != "correct" else [])
    ]


def detail_lines(result):
    """All that was measured."""
    lines = [(scene["scene"], f"{scene['verdict']}: {', '.join(scene_words(scene))}") for scene in result["scenes"]]
    if found := result["diagnosis"]:
        lines += [("seen", sentence) for fact in found["facts"] for sentence in fact["evidence"]]
        lines += [("right", subject) for subject in found["right"]]
    return lines


def laid_out(lines, stream=None):
    """Lines as text: on a terminal wrapped, with the verdict in colour."""
    if not stream or not stream.isatty():
        return "\n".join(f"{head:{MARGIN - 1}} {text}" for head, text in lines)
    width = max(shutil.get_terminal_size().columns, 2 * MARGIN)
    shown = []
    for head, text in lines:
        text = textwrap.fill(text, width - MARGIN, break_long_words=False, break_on_hyphens=False)
        start, end = ("", "") if os.environ.get("NO_COLOR") else (f"\033[{COLOURS.get(head, 1)}m", "\033[0m")
        shown.append(f"{start}{head:{MARGIN - 1}}{end} " + text.replace("\n", "\n" + " " * MARGIN))
    return "\n".join(shown)


def short_lines(result):
    """The result as a few lines."""
    lines = [headline(result), *hint_lines(result), ("file", f"{result['file']}, as chapter {result['chapter']}")]
    return [*lines, *([("where", result["picture"])] if result["picture"] else [])]
