"""Command lines of the tools that measure: mistakes are reported in one line, as the chapters do."""
import argparse
import signal
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


def run_resumable(work, failure):
    """Does work that goes on where it was interrupted; a failure of that type is told in one line."""
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        work()
    except failure as error:
        sys.exit(f"error: {error}")
    except KeyboardInterrupt:
        sys.exit("interrupted: the same command goes on")
