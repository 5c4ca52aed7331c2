"""A playground without pixels: points from the lab's samplers against their density, and the integrals that they
estimate, as text and as a picture. The points come from the chapters' shaders, so a change there shows here. With the number of a
chapter, or of a copy of one, instead of a name, it is that folder's own sampler.
"""
import math
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable

import numpy as np
from lesson import point_sets
from project import CHAPTERS, ROOT, Parser, UserError, number, original, program_file, run_program
from report.numbers import CONFIDENCE, two_sided
from report.studies import named
from scipy.special import chdtrc

PROGRAM = program_file("sample_points")
BINS = 16
CHANCE = 4.5  # in standard errors: the largest of BINS deviations rarely exceeds it
SECTORS = 8  # of the other coordinate, for the chi-square test
LEAST_EXPECTED = 5  # points in a cell of that test: others are joined
SIGNIFICANCE, ROUNDING = 1e-4, 1e-3


@dataclass
class Integral:
    formula: str
    value: Callable  # exact, for a number of dimensions
    terms: Callable  # of points [index, column]: f/p of each, whose mean estimates the integral


@dataclass
class Playground:
    title: str
    sampler: str  # for the program sample_points
    integrals: list
    coordinate: str  # shown by the histogram
    coordinates: Callable = lambda points: points[:, 0]
    cumulative: Callable = lambda x: x  # distribution function of that coordinate
    others: Callable = lambda points: points[:, 1]  # another coordinate, uniform from 0 to 1 and independent of the first
    other: str = "u_y"
    dimensions: int = 2
    kind: str = "square"  # how points are drawn: square, disk (directions from above), aperture or triangle
    is_pixel: bool = False  # whether the points are samples of one pixel, rather than the first of as many pixels
    chapter: str = next(iter(CHAPTERS.values()))  # whose shader generates the points


def drop_lost(points):
    """The directions that the estimator actually traced."""
    return points[np.any(points[:, :3] != 0, axis=1)]


DARTS = Integral(
    "area of the quarter disk, ∫ [u_x² + u_y² < 1] du",
    lambda k: math.pi / 4,
    lambda u: (u[:, 0] ** 2 + u[:, 1] ** 2 < 1).astype(float),
)
COSINES = [
    Integral("∫ n·ω dω over the hemisphere", lambda k: math.pi, lambda p: math.pi * p[:, 3]),
    Integral("∫ (n·ω)² dω over the hemisphere", lambda k: 2 * math.pi / 3, lambda p: math.pi * p[:, 3] * p[:, 2]),
]
MEAN_SQUARE = Integral("∫ ((u_1 + … + u_k) / k)² du over [0,1]^k", lambda k: 1 / 4 + 1 / (12 * k), lambda u: u.mean(axis=1) ** 2)
COMPARED = {"the quarter disk's area": DARTS, "a smooth integral": MEAN_SQUARE}  # with each point set

PLAYGROUNDS = {
    "1d": Playground(
        "1D Monte Carlo integration",
        "numbers",
        [Integral("∫ sin(π u) du from 0 to 1", lambda k: 2 / math.pi, lambda u: np.sin(np.pi * u[:, 0]))],
        "u",
        dimensions=1,
    ),
    "kd": Playground(
        "kD Monte Carlo integration; --dimensions sets k", "numbers", [MEAN_SQUARE], "u_1", other="u_2", dimensions=4
    ),
    "numbers": Playground("pairs of random numbers by PCG2D, shaders/world/random.glsl", "numbers", [DARTS], "u_x"),
    "blog-hash": Playground(
        "what the blog takes for random numbers: frac(sin(dot(p, …)) · 43758.5)", "blog-hash", [DARTS], "u_x"
    ),
}

# What a chapter's chapter.json calls "points": the sampler, and what else its playground needs.
KINDS = {
    "directions": (
        "directions",
        {
            "integrals": COSINES,
            "coordinate": "cos θ",
            "coordinates": lambda p: drop_lost(p)[:, 2],
            "kind": "disk",
            "others": lambda p: np.arctan2(drop_lost(p)[:, 1], drop_lost(p)[:, 0]) / (2 * math.pi) + 0.5,
            "other": "φ",
        },
    ),
    "light points": (
        "light points",
        {
            "integrals": [Integral("∫ w_1 dA over the triangle", lambda k: 1 / 3, lambda w: w[:, 0])],
            "coordinate": "w_1",
            "kind": "triangle",
            "others": lambda w: w[:, 1] / np.maximum(1 - w[:, 0], 1e-30),
            "other": "w_2 / (1 - w_1)",
        },
    ),
    "lens points": (
        "lens points",
        {
            "integrals": [
                Integral("∫ r² dA over the unit disc", lambda k: math.pi / 2, lambda p: math.pi * (p**2).sum(axis=1))
            ],
            "coordinate": "r²",
            "coordinates": lambda p: (p**2).sum(axis=1),
            "kind": "aperture",
            "others": lambda p: np.arctan2(p[:, 1], p[:, 0]) / (2 * math.pi) + 0.5,
            "other": "φ",
        },
    ),
    "pixel": ("numbers", {"integrals": [DARTS, MEAN_SQUARE], "coordinate": "u_x", "is_pixel": True}),
}


def playground_of(chapter, points, title, cumulative):
    """The playground of a chapter's sampler; `cumulative` is a formula of x."""
    sampler, options = KINDS[points]
    function = eval(f"lambda x: {cumulative}", vars(np))
    return Playground(title.format(number=int(chapter[:2])), sampler, cumulative=function, chapter=chapter, **options)


OF_CHAPTERS = {name: playground_of(chapter, **content) for name, (chapter, content) in named("samplers").items()}
PLAYGROUNDS |= OF_CHAPTERS


def own_playground(number):
    """The playground of a chapter's sampler, or of the chapter that it is a copy of, with its own shaders; None if there is none."""
    if not number.isdecimal() or int(number) not in CHAPTERS:
        return None
    chapter, title = CHAPTERS[int(number)], CHAPTERS[original(int(number))]
    return next((playground_of(chapter, **content) for owner, content in named("samplers").values() if owner == title), None)


def draw(playground, count, seed, dimensions, device=None, samples=1):
    """Array [index, column] of points: the first ones of the pixels, or `samples` of each pixel."""
    result = run_program(
        [PROGRAM, playground.sampler, playground.chapter, count, samples, seed, dimensions, device or ""],
        encoding=None,
        errors=None,
    )
    if result.returncode != 0:
        raise UserError(
            result.stderr.decode().strip().removeprefix("error: ") or f"{PROGRAM.name} ended with {result.returncode}"
        )
    return np.frombuffer(result.stdout, np.float32).reshape(count, -1).astype(float)


def draw_sets(seed, device=None, points=None):
    """Name -> points [pixel, index, axis] of many pixels: random ones, Sobol's, and scrambled ones of a chapter or its copy."""
    points = points or next(playground for playground in PLAYGROUNDS.values() if playground.is_pixel)
    kinds = {"random": PLAYGROUNDS["numbers"], "Sobol": replace(points, sampler="sobol"), "scrambled": points}
    return {
        name: draw(kind, point_sets.PIXELS * point_sets.SIZE, seed, 2, device, point_sets.SIZE).reshape(point_sets.PIXELS, -1, 2)
        for name, kind in kinds.items()
    }


def histogram(playground, points):
    """Edges of bins, with the observed and expected numbers of points in them."""
    values = playground.coordinates(points)
    counts, edges = np.histogram(values, BINS, (0, 1))
    return edges, counts, np.diff(playground.cumulative(edges)) * len(values)


def chi_square(playground, points):
    """Pearson's test whether points follow their density in both coordinates: statistic, degrees of freedom, and the probability of one
    as large by chance."""
    has_other = points.shape[1] > 1
    first = playground.coordinates(points)
    others, sectors = (playground.others(points), SECTORS) if has_other else (np.zeros(len(first)), 1)
    rounded = [np.where(abs(values - values.clip(0, 1)) < ROUNDING, values.clip(0, 1), values) for values in (first, others)]
    counts, edges, _ = np.histogram2d(*rounded, (BINS, sectors), ((0, 1), (0, 1)))
    expected = np.repeat(np.diff(playground.cumulative(edges)) * len(first) / sectors, sectors)
    cells = [[len(first) - counts.sum(), 0.0]]  # outside, where none should be
    for i in np.argsort(expected):
        if cells[-1][1] >= LEAST_EXPECTED:
            cells.append([0.0, 0.0])
        cells[-1] = [cells[-1][0] + counts.ravel()[i], cells[-1][1] + expected[i]]
    if len(cells) > 1 and cells[-1][1] < LEAST_EXPECTED:
        last = cells.pop()
        cells[-1] = [sum(pair) for pair in zip(cells[-1], last)]
    statistic, freedom = sum((count - mean) ** 2 / mean for count, mean in cells), len(cells) - 1
    return statistic, freedom, float(chdtrc(freedom, statistic)) if freedom else 1.0


def estimates(terms):
    """Rows (N, mean, half of the 95 % interval) for N = 1, 4, 16, …; a single term has no interval."""
    rows, sizes = [(1, terms[0], math.nan)], [4**k for k in range(1, 16) if 4**k <= len(terms)]
    for n in sizes:
        rows.append((n, terms[:n].mean(), two_sided(CONFIDENCE, n - 1) * terms[:n].std(ddof=1) / math.sqrt(n)))
    return rows


def grid_rows(integral, dimensions, limit):
    """Rows (N, error of a grid of corners, error of a grid of midpoints) for as many N as fit."""
    exact, rows = integral.value(dimensions), []
    for side in (2**k for k in range(1, 21)):
        if side**dimensions > limit:
            break
        errors = [abs(integral.terms(point_sets.grid(side, dimensions, offset)).mean() - exact) for offset in (0, 0.5)]
        rows.append((side**dimensions, *errors))
    return rows


def report(playground, points, dimensions):
    """The printed text."""
    edges, counts, expected = histogram(playground, points)
    lines = [playground.title, "", f"{playground.coordinate:>12}   points  expected"]
    scale = 40 / max(counts.max(), expected.max())
    for low, high, count, mean in zip(edges, edges[1:], counts, expected):
        lines.append(f"{low:5.3f}–{high:5.3f} {count:8d} {mean:9.1f}  {'#' * round(scale * count)}")
    deviation = (np.abs(counts - expected) / np.sqrt(expected * (1 - expected / expected.sum()))).max()
    lines.append(
        f"largest deviation of a count: {deviation:.1f} standard errors, "
        + ("too large for chance" if deviation > CHANCE else f"which is chance: below {CHANCE}")
    )
    statistic, freedom, chance = chi_square(playground, points)
    names = [playground.coordinate, playground.other][: points.shape[1]]
    lines.append(
        f"chi² of {' and '.join(names)}: {statistic:.1f} at {freedom} degrees of "
        f"freedom, p = {chance:.2g}, " + ("too large for chance" if chance < SIGNIFICANCE else "which is chance")
    )
    for integral in playground.integrals:
        exact = integral.value(dimensions)
        lines += ["", f"{integral.formula} = {exact:.6f}", f"{'N':>9}   estimate   95 % interval        error"]
        for n, mean, half in estimates(integral.terms(points)):
            margin = "" if math.isnan(half) else f"± {half:.6f}"
            lines.append(f"{n:9d}  {mean:9.6f}   {margin:13s}  {mean - exact:+11.6f}")
    if playground is PLAYGROUNDS["kd"]:
        lines += ["", f"On a grid in {dimensions} dimensions:", f"{'N':>9}   error of corners  error of midpoints"]
        rows = grid_rows(playground.integrals[0], dimensions, len(points))
        lines += [f"{n:9d}   {corners:16.6f}  {midpoints:18.6f}" for n, corners, midpoints in rows]
    return "\n".join(lines)


def parse():
    names = "\n".join(f"  {name:15s} {playground.title}" for name, playground in PLAYGROUNDS.items())
    parser = Parser("./lab sample", __doc__, epilog=f"names:\n{names}")
    parser.add_argument(
        "name", nargs="?", metavar="NAME|N", help="what to sample, or a chapter or copy; without, the names are listed"
    )
    parser.add_argument("--count", type=number(int, 16, 1 << 22), default=4096, help="number of points; default: 4096")
    parser.add_argument("--seed", type=number(int, 0, 2**32 - 1), default=0, help="chooses the random numbers; default: 0")
    parser.add_argument("--dimensions", type=number(int, 1, 8), help="k of kd; default: 4")
    parser.add_argument("--device", help="number or part of the name of the device")
    parser.add_argument("--output", type=Path, help="picture; default: output/sample_NAME.png")
    options = parser.parse_args()
    if options.name is None:
        print(f"Samplers, to be shown by ./lab sample NAME:\n{names}")
        sys.exit()
    options.playground = PLAYGROUNDS.get(options.name) or own_playground(options.name)
    if not options.playground:
        parser.error(f"there is no sampler '{options.name}': {', '.join(PLAYGROUNDS)}, or a chapter that has one, or its copy")
    if options.output and options.output.suffix != ".png":
        parser.error(f"--output: '{options.output}' must end in .png")
    if options.dimensions and options.name != "kd":
        parser.error("--dimensions belongs to kd")
    return options


def main():
    options = parse()
    playground = options.playground
    dimensions = options.dimensions or playground.dimensions
    samples = options.count if playground.is_pixel else 1
    points = draw(playground, options.count, options.seed, dimensions, options.device, samples)
    if not np.isfinite(points).all() or not len(playground.coordinates(points)):
        raise UserError(
            f"chapters/{playground.chapter}: its sampler returns no direction, or numbers that are infinite or not a number"
        )
    print(report(playground, points, dimensions))
    if playground.is_pixel:
        sets = draw_sets(options.seed, options.device, playground)
        print("\n".join(point_sets.report(sets, COMPARED)))
    output = options.output or ROOT / f"output/sample_{options.name}.png"
    from lesson import sample_plots  # imported late: Matplotlib takes longer to load than everything else

    try:
        if playground.is_pixel:
            sample_plots.save_point_sets(output, sets, COMPARED)
        else:
            sample_plots.save_overview(output, playground, points, dimensions, histogram, estimates)
    except OSError as error:
        raise UserError(f"{output}: cannot be written: {error}") from None
    print(f"\npicture        {output}")
