"""Progress of long work: a bar with the time left on a terminal, a few plain lines elsewhere."""
import sys
import time

BAR_WIDTH = 24


def duration_text(seconds):
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.1f} minutes"


def show_progress(name, done, count, started):
    """`done` of `count` equal steps, the first of which started at `started` by time.monotonic()."""
    left = duration_text((time.monotonic() - started) * (count - done) / max(done, 1))
    if sys.stderr.isatty():
        filled = BAR_WIDTH * done // count
        bar = "#" * filled + "-" * (BAR_WIDTH - filled)
        print(f"\r\033[K[{bar}] {100 * done // count} %, {left} left: {name}", end="\n" if done == count else "",
              file=sys.stderr, flush=True)
    elif done in (1, count) or 4 * done // count > 4 * (done - 1) // count:
        print(f"{100 * done // count} %, {left} left: {name}", file=sys.stderr, flush=True)
