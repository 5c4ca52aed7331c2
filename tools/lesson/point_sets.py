"""Point sets in the unit square, as used by pixels of a render: their spectra, and how fast the errors of estimates fall. Random
and Sobol points come from the shaders."""
import numpy as np

PIXELS, SIZE = 64, 4096  # number of sets of each kind, and points per set
SPECTRUM_SIZE, FREQUENCIES = 256, 40  # points of a set whose spectrum is shown, and its largest frequency
SIZES = [4**k for k in range(7)]


def grid(side, dimensions, offset):
    """Points of a regular grid on [0,1]^k with `side` points along each axis."""
    axis = (np.arange(side) + offset) / side
    return np.stack(np.meshgrid(*[axis] * dimensions, indexing="ij"), axis=-1).reshape(-1, dimensions)


def first_points(sets, name, size):
    """The first points of each set; a grid differs for every size."""
    return grid(round(size**0.5), 2, 0.5)[None] if name == "grid" else sets[name][:, :size]


def spectrum(points):
    """|Σ exp(-2πi f·u)|² / N for frequencies f from -FREQUENCIES to FREQUENCIES along each axis, averaged over the sets. It is 1
    for random points, and 0 at 0, which is left out. The variance of an estimate is the sum of its products with the
    integrand's spectrum, divided by N."""
    waves = np.exp(
        -2j * np.pi * np.arange(-FREQUENCIES, FREQUENCIES + 1)[:, None, None, None] * points
    )  # frequency, pixel, index, axis
    sums = np.einsum("apn,bpn->pba", waves[..., 0], waves[..., 1])
    power = (abs(sums) ** 2).mean(axis=0) / points.shape[1]
    power[FREQUENCIES, FREQUENCIES] = 0
    return power


def spectra(sets):
    return {name: spectrum(first_points(sets, name, SPECTRUM_SIZE)) for name in ("grid", *sets)}


def errors(sets, integral):
    """Name -> errors of estimates from SIZES points: root mean squares over the sets."""
    exact = integral.value(2)

    def error(points):
        terms = integral.terms(points.reshape(-1, 2)).reshape(points.shape[:2])
        return np.sqrt(((terms.mean(axis=1) - exact) ** 2).mean())

    return {name: [error(first_points(sets, name, size)) for size in SIZES] for name in ("grid", *sets)}


def slope(values):
    """The log-log slope of the errors against SIZES points."""
    return np.polyfit(np.log(SIZES), np.log(values), 1)[0]


def report(sets, integrals):
    """The errors as text, with a table for each integral."""
    lines = []
    for title, integral in integrals.items():
        table = errors(sets, integral)
        lines += [
            "",
            f"Error of {title} from the first N samples of a pixel, root mean square over {PIXELS} pixels:",
            f"{'N':>9}" + "".join(f"{name:>12}" for name in table),
        ]
        lines += [f"{size:9d}" + "".join(f"{values[i]:12.6f}" for values in table.values()) for i, size in enumerate(SIZES)]
        lines.append(f"{'slope':>9}" + "".join(f"{slope(values):12.2f}" for values in table.values()))
    return lines
