"""Prints the folders of the chapters whose numbers are among the words, and those that they copy, for ./lab to build: perhaps too many."""
import re
import sys

from project import CHAPTERS, original


def main():
    numbers = {int(word) for word in sys.argv[1:] if re.fullmatch("[0-9]{1,2}", word)} & set(CHAPTERS)
    print(*sorted({CHAPTERS[chapter] for number in numbers for chapter in (number, original(number))}))
