"""Command lines of the tools that measure: mistakes are reported in one line, as the chapters do."""
import argparse
import sys


class Parser(argparse.ArgumentParser):
    def error(self, message):
        sys.exit(f"error: {message}; {self.prog} --help lists the options")


def at_least(least, kind):
    """Converts an argument to a number that is not less."""
    def convert(text):
        value = kind(text)
        if not least <= value < 1e9:
            raise ValueError
        return value

    convert.__name__ = f"number from {least:g}"
    return convert


def add_device_options(parser):
    parser.add_argument("--backend", choices=["auto", "pipeline", "query", "compute"], default="auto", help="default: auto")
    parser.add_argument("--device", help="number or part of the name of the device")
