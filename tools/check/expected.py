"""What a check expects: of each chapter its chapter.json, what its own shader shows, and what each mistake does."""
from project import CHAPTERS, KNOWLEDGE, ROOT, description, original, read_json

DESCRIPTIONS = {number: description(folder) for number, folder in CHAPTERS.items()}


def expected_file(chapter):
    """What the chapter's own shader shows, or that of the chapter that this one copies: levels and experiments."""
    return ROOT / "assets/expected" / f"{CHAPTERS[original(chapter)]}.json"


def known_mistakes(chapter):
    """What each mistake of the catalogue shows in the experiments. The notebook learns it; without the notebook mistakes have no names."""
    file = KNOWLEDGE / expected_file(chapter).name
    return read_json(file) if file.exists() else {}
