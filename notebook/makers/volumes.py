"""Grids of densities by formula."""
import struct

import numpy as np


def encode_vol(densities):
    """Mitsuba's format: a header, then 32-bit numbers in the order of [z, y, x]. The box in it is the unit cube."""
    depth, height, width = densities.shape
    return b"VOL\x03" + struct.pack("<5i6f", 1, width, height, depth, 1, 0, 0, 0, 1, 1, 1) + densities.astype("<f4").tobytes()


def value_noise(points, seed):
    """Random values at integer points, interpolated smoothly in between: from -1 to 1."""
    lattice = np.random.RandomState(seed).uniform(-1, 1, (16, 16, 16))
    first = np.floor(points).astype(int)
    weight = points - first
    weight = weight * weight * (3 - 2 * weight)
    total = 0
    for corner in np.ndindex(2, 2, 2):
        x, y, z = np.moveaxis((first + corner) % 16, -1, 0)
        total = total + lattice[x, y, z] * np.prod(np.where(corner, weight, 1 - weight), axis=-1)
    return total


def smoke():
    """A column that sways, widens and frays as it rises: densities from 0 to 1."""
    width, height = 40, 46
    z, y, x = (2 * (np.arange(n) + 0.5) / n - 1 for n in (width, height, width))
    z, y, x = np.meshgrid(z, (y + 1) / 2, x, indexing="ij")
    points = np.stack([x, 2.3 * y, z], axis=-1)
    # Eddies move the points before their distance to the axis counts, larger ones farther.
    for seed, scale in enumerate((2, 4, 8)):
        eddies = [value_noise(scale * points + 5.5, 3 * seed + axis) for axis in range(3)]
        points = points + np.stack(eddies, axis=-1) * (1.1 * y[..., None] + 0.06) / scale**0.8
    distance = np.hypot(points[..., 0] - 0.15 * np.sin(4 * y), points[..., 2] - 0.15 * np.sin(5 * y))
    inside = np.clip(1.7 - 1.7 * distance / (0.08 + 0.5 * y), 0, 1)
    fade = np.clip(np.minimum(y / 0.03, (1 - y) / 0.3), 0, 1) * (1 - 0.5 * y)
    border = np.clip(8 * (1 - np.maximum(abs(x), abs(z))), 0, 1)
    return np.round(inside * fade * border, 3)
