"""What a renderer's frames add up to, as rows of a chapter's report."""
import itertools
import math

from peers.renderers import SAMPLERS, Frame
from references.images import rel_mse

CALLS = 8  # with independent samples, for a curve. Other samplers stratify the samples within a call, so fewer calls err less.
GROWTH = 8  # factor between the samples of calls, until the time is up
FEW = 64  # samples: renders of fewer are repeated, since they end too soon to be timed


class Film:
    """A running mean of frames; each has a seed of its own."""

    def __init__(self, renderer, reference, seed):
        self.renderer, self.reference, self.seed, self.calls = renderer, reference, seed, 0
        self.total = None

    def call(self, samples):
        self.calls += 1
        return self.renderer.render(min(samples, self.renderer.largest), self.seed * 65536 + self.calls)

    def add(self, samples):
        frame, total = self.call(samples), self.total
        if total:
            sum_of = total.samples + frame.samples
            mean = (total.samples * total.image + frame.samples * frame.image) / sum_of
            frame = Frame(mean, sum_of, total.seconds + frame.seconds, total.cpu_seconds + frame.cpu_seconds)
        self.total = frame

    def row(self, frame):
        return {
            "samples": frame.samples,
            "seconds": frame.seconds,
            "cpu_seconds": frame.cpu_seconds,
            "mean": frame.image.mean(axis=(0, 1)).tolist(),
            "rel_mse": rel_mse(frame.image, self.reference) if self.reference else None,
        }


def growing_rows(film, options):
    """Rows of one picture after 1, 2, 4, … calls, until it has its samples or its time."""
    if options.samples:
        (samples,) = options.samples
        calls = max(CALLS if options.sampler == SAMPLERS[0] else 1, math.ceil(samples / film.renderer.largest))
        parts = itertools.repeat(math.ceil(samples / calls))
    else:
        parts = (GROWTH**power for power in itertools.count())
    rows = []
    for number, part in enumerate(parts, 1):
        film.add(part)
        is_last = film.total.samples >= samples if options.samples else film.total.seconds >= options.time_limit
        if is_last or number.bit_count() == 1:
            rows.append(film.row(film.total))
        if is_last:
            return rows


def mean_row(rows):
    """The mean of each number, and of each channel; without a reference there is no error."""
    columns = {key: [row[key] for row in rows] for key in rows[0]}
    means = {key: None if None in values else sum(values) / len(rows) for key, values in columns.items() if key != "mean"}
    return means | {"mean": [sum(channel) / len(rows) for channel in zip(*columns["mean"])]}


def separate_rows(film, counts):
    """A row for each number of samples: the mean over pictures of their own, one or more."""
    for samples in counts:
        yield mean_row([film.row(film.call(samples)) for _ in range(max(1, FEW // samples))])
