"""Lamps in the same place as other triangles: rays would find either by chance, in Mitsuba as elsewhere.

As in the chapters, of triangles in the same place that face the same way the first that emits counts, and two that face opposite
ways are the sides of a sheet. What the chapters leave to chance is refused.
"""
import itertools

import numpy as np
from project import UserError
from references.meshes import triangle_normals

GAP = 1e-4  # between the sides of a sheet, in its diagonal: small in pictures, large in 32 bits
SAME_PLANE = 1e-6  # in the largest coordinate
CHUNK = 256  # triangles


def get_places(positions):
    """For each triangle the number of its place, from its corners in 32 bits in any order, and the side that its front is on."""
    corners = positions.astype(np.float32) + np.float32(0)  # adding 0 removes negative zeros
    order = np.lexsort(corners.transpose(2, 0, 1)[::-1], axis=-1)
    corners = np.take_along_axis(corners, order[:, :, None], axis=1)
    numbers = {}
    places = np.array([numbers.setdefault(corner.tobytes(), len(numbers)) for corner in corners])
    return places, (order[:, 1] - order[:, 0]) % 3 == 1


def resolve_place(triangles, materials, fronts, owners):
    """Those of the triangles in a place that stay; None if that is left to chance."""
    by_owner = []
    for _, group in itertools.groupby(triangles, owners.__getitem__):
        sides = {}
        for i in sorted(group, key=lambda i: not materials[i].emission.any()):
            sides.setdefault(fronts[i], i)
        by_owner.append(sides)
    kept = by_owner[0]
    is_clear = not any(materials[i].refractive_index > 0 for i in triangles) and all(
        sides.keys() == kept.keys() and all(materials[sides[front]].equals(materials[kept[front]]) for front in kept)
        for sides in by_owner
    )
    return list(kept.values()) if is_clear else None


def overlap(first, second, tolerance):
    """Whether triangles of each pair lie in the same plane and have an area in common: no edge separates them."""
    distances = [
        np.abs(((b - a[:, :1]) * triangle_normals(a)[:, None]).sum(axis=2)).max(axis=1)
        for a, b in ((first, second), (second, first))
    ]
    edges = np.concatenate([np.roll(corners, -1, axis=1) - corners for corners in (first, second)], axis=1)
    axes = np.cross(edges, triangle_normals(first)[:, None])
    axes /= np.maximum(np.linalg.norm(axes, axis=2, keepdims=True), 1e-300)
    low, high = (
        [limit(np.einsum("pci,pai->pac", corners, axes), axis=2) for corners in (first, second)] for limit in (np.min, np.max)
    )
    depth = (np.minimum(*high) - np.maximum(*low)).min(axis=1)
    size = np.minimum(*(np.linalg.norm(np.ptp(corners, axis=1), axis=1) for corners in (first, second)))
    return (np.minimum(*distances) <= tolerance) & (depth > GAP * size)


def near_pairs(positions, chosen, others, tolerance):
    """Pairs of indices of triangles whose boxes meet, in several arrays."""
    low, high = positions.min(axis=1), positions.max(axis=1)

    def near_box(triangles, around):
        return around[
            (low[around] <= high[triangles].max(axis=0) + tolerance).all(axis=1)
            & (high[around] >= low[triangles].min(axis=0) - tolerance).all(axis=1)
        ]

    chosen = chosen[np.argsort(low[chosen, 0])]
    others = near_box(chosen, others)
    for chunk in np.array_split(chosen, max(1, len(chosen) // CHUNK)):
        near = near_box(chunk, others)
        boxes = (low[near] <= high[chunk, None] + tolerance) & (high[near] >= low[chunk, None] - tolerance)
        rows, columns = boxes.all(axis=2).nonzero()
        yield np.stack([chunk[rows], near[columns]], axis=1)


def find_overlap(positions, places, lamps, others):
    """A lamp that shares a part of its plane with another triangle in another place; None if there is none."""
    scale = SAME_PLANE * np.abs(positions).max(axis=(1, 2))
    for pairs in near_pairs(positions, lamps, others, scale.max()):
        pairs = pairs[places[pairs[:, 0]] != places[pairs[:, 1]]]
        found = pairs[overlap(positions[pairs[:, 0]], positions[pairs[:, 1]], scale[pairs].max(axis=1))]
        if len(found):
            return found[0, 0]
    return None


def resolve_lamps(path, positions, materials, owners):
    """Positions [triangle, corner] in which the sides of sheets lie apart, and which triangles stay. `owners` are the numbers of
    their placements."""
    is_lamp = np.array([material.emission.any() for material in materials])
    is_kept, moved = np.ones(len(materials), bool), positions.copy()
    if not is_lamp.any():
        return moved, is_kept

    def refuse(triangle):
        centre = ", ".join(f"{x:.4g}" for x in positions[triangle].mean(axis=0))
        raise UserError(
            f"{path}: a lamp of material '{materials[triangle].name}' and another triangle share a place around "
            f"({centre}): rays find either by chance, so that there is no reference; move one of them"
        )

    places, fronts = get_places(positions)
    shared = {place: [] for place in places[is_lamp]}
    for i in np.isin(places, places[is_lamp]).nonzero()[0]:
        shared[places[i]].append(i)
    sides = []
    for triangles in shared.values():
        if len(triangles) == 1:
            continue
        kept = resolve_place(triangles, materials, fronts, owners)
        if kept is None:
            refuse(triangles[0])
        is_kept[triangles] = False
        is_kept[kept] = True
        sides += kept if len(kept) == 2 else []
    overlapping = find_overlap(positions, places, (is_lamp & is_kept).nonzero()[0], is_kept.nonzero()[0])
    if overlapping is not None:
        refuse(overlapping)
    for owner in np.unique(owners[sides]):
        sheet = [i for i in sides if owners[i] == owner]
        gap = GAP * np.linalg.norm(np.ptp(positions[sheet].reshape(-1, 3), axis=0))
        moved[sheet] += gap / 2 * triangle_normals(positions[sheet])[:, None]
    return moved, is_kept
