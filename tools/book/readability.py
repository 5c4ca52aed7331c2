"""Measures sentences: python3 tools/book/readability.py PAGE.md ... prints the median of words per sentence and the sentences that
are too long. Code, tables, headings and formulas on lines of their own do not count; code and formulas inside a sentence count
as one word.
"""
import re
import sys
from pathlib import Path
from statistics import median

MEDIAN_GOAL, LONGEST_GOAL = 17, 40  # words per sentence
LABEL = 2  # a sentence of at most this many words is a label, such as "Fill in."
NO_TEXT = [
    r"^( *)(```|~~~)(?s:.*?)^\1\2 *$",
    r"<!--(?s:.*?)-->",
    r"^ *\$\$(?s:.*?)\$\$ *$",
    r"^#.*$",
    r"^ *\|.*$",
    r"^!\[.*?\]\(.*?\)$",
    r"(?<=\n\n)(?: {4}.*\n|\n(?= {4}))+",
]
ONE_WORD = [r"`[^`]+`", r"\$[^$\n]+\$"]


def sentences(text):
    """The sentences of a page, as plain text."""
    for piece in NO_TEXT:
        text = re.sub(piece, "\n\n", text, flags=re.MULTILINE)
    text = re.sub(r"!?\[([^\[\]]*)\]\([^()]*\)", r"\1", text)
    for piece in ONE_WORD:
        text = re.sub(piece, lambda match: re.sub(r"[\s.!?]+", "_", match[0]), text)
    text = re.sub(r"\*+|</?[a-z][^<>]*>", "", text)
    # A list item is a paragraph of its own.
    paragraphs = re.split(r"\n\s*\n|(?:\A|\n)\s*(?:[-+]|\d+\.)\s+", text)
    found = [
        " ".join(sentence.split())
        for paragraph in paragraphs
        for sentence in re.split(r"(?<=[.!?])[\"”)]*\s+(?=[^a-z])", paragraph)
    ]
    return [sentence for sentence in found if count_words(sentence) > LABEL]


def count_words(sentence):
    return sum(re.search(r"\w", word) is not None for word in sentence.split())


def length(text):
    """The number of words in all sentences of a page."""
    return sum(map(count_words, sentences(text)))


def measure(text):
    """(median of the words per sentence, [(words, sentence) above the goal]) of a page; 0 for a page without sentences."""
    counted = [(count_words(sentence), sentence) for sentence in sentences(text)]
    long = sorted((pair for pair in counted if pair[0] > LONGEST_GOAL), reverse=True)
    return median([words for words, _ in counted] or [0]), long


def main():
    for name in sys.argv[1:]:
        middle, long = measure(Path(name).read_text(encoding="utf-8"))
        print(f"{name}: median {middle:g} (goal {MEDIAN_GOAL}), {len(long)} sentences above {LONGEST_GOAL} words")
        for words, sentence in long:
            print(f"  {words}: {sentence}")


if __name__ == "__main__":
    main()
