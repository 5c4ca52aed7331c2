"""Prints the folders of the chapters whose numbers are among the words, and of those that they copy, for ./lab to build: perhaps too many."""
import sys

from project import CHAPTERS, original


def main():
    numbers = [number for number in CHAPTERS if {f"{number}", f"{number:02}"} & set(sys.argv)]
    print(*sorted({CHAPTERS[chapter] for number in numbers for chapter in (number, original(number))}))
