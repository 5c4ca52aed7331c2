"""What a check reports about a shader, in words."""
from check.grading import early_bias
from project import CHAPTERS

MOST_QUESTIONS = 2
SIMILAR = "no common mistake fits all that was seen, but two are similar: it may be one of them, or neither"
NOTHING_SEEN = ("none of the experiments finds what is wrong in the pictures, so all that they look at is right: look at the places that the "
                "picture of the differences frames")


def percent(value):
    return f"{100 * value:+.2g} %" if abs(value) < 0.1 else f"{100 * value:+.0f} %"


def tell_early(cases):
    """What is certain after the first runs."""
    scene, value = early_bias(cases)
    if scene:
        words = f"{scene} is too {'bright' if value > 0 else 'dark'} ({percent(value)})"
    else:
        words = f"no picture is wrong by {100 * value:.2g} % or more in its mean" if value < 1 else "nothing is sure yet"
    print(f"{'so far':14} {words}; smaller differences take all renders", flush=True)


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
        words.append(f"a bias from {100 * least:.2g} % would have shown")
        if scene["noise"][0] is not None:
            limit = f", where {scene['most_noise']:.2f} is the limit" if scene["verdict"] == "noisy" else ""
            words.append(f"{scene['noise'][0]:.2f} times the noise of the chapter's own shader (95 % interval "
                         f"{scene['noise'][1]:.2f} to {scene['noise'][2]:.2f}{limit})")
        words.append(f"{scene['rays']:.2f} times its rays")
    return words


def hint_lines(result):
    """Pairs of a word and a lead to the mistake: what the experiments have shown, and questions if few mistakes can cause it."""
    if result["unfinished_line"]:
        return [("unfinished", f"{result['unfinished_file']}:{result['unfinished_line']} says TODO")]
    found = result["diagnosis"]
    if result["verdict"] == "correct" or not found:
        return []
    lines = [("seen", fact) for fact in found["facts"]] or [("seen", NOTHING_SEEN)]
    lines += [("right", "; ".join(found["right"]))] if found["right"] else []
    page, mistakes = f"chapters/{CHAPTERS[result['chapter']]}/README.md", found["mistakes"]
    if mistakes and not found["fits"]:
        lines.append(("not sure", SIMILAR))
    if len(mistakes) <= MOST_QUESTIONS:
        for first, mistake in zip(("ask yourself", "or") if found["fits"] else ("maybe", "maybe"), mistakes):
            name = f"{mistake['name']}: " if "name" in mistake else ""
            lines += [(first, name + mistake["hint"]), ("read again", f"{mistake['slide']} (docs/slides.md), {page}")]
    if len(mistakes) > 1 and found["fits"]:
        lines.append(("not sure", f"{len(mistakes)} common mistakes show the same in all experiments"))
    if found["next"] and len(mistakes) != 1:
        lines.append(("next", f"see it with your shader in the chapter's folder: {found['next']}"))
    return lines


def explain(result):
    """The result as text, one line per scene."""
    lines = [(scene["scene"], f"{scene['verdict']}: {', '.join(scene_words(scene))}") for scene in result["scenes"]]
    lines += [("where", result["picture"])] if result["picture"] else []
    lines += [*hint_lines(result), (f"chapter {result['chapter']}", f"{result['verdict']}: {result['file']}")]
    return "\n".join(f"{head:14} {text}" for head, text in lines)
