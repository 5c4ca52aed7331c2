"""Which medium is where: that of the smallest body around a point, else the fog. scenes.md says what a body is.

Mitsuba moves rays off surfaces by its epsilon, so that it has no right picture of bodies that touch something: they are refused,
and so is what has no clear inside.
"""
from dataclasses import dataclass

import numpy as np
from project import UserError
from references.lamps import near_pairs, overlap
from references.meshes import triangle_normals

TOUCHING = 4e-4  # in the largest coordinate: twice what Mitsuba moves a ray by
ASIDE = 1e-7  # from a surface to where its sides are asked for, in the largest coordinate
ASKED = 16  # triangles of a body, or a few more
MOST_OPEN = 16  # bodies: behind 20 open ones Mitsuba 3 shows 0.33 of a light of 0.35, and behind 26 hardly any


@dataclass(eq=False)
class Body:
    triangles: np.ndarray  # indices
    content: dict | None  # a medium, or the absorption of glass
    is_open: bool
    is_closed: bool  # without holes
    corners: np.ndarray  # [triangle, corner]
    sides: tuple = (None, None)  # what is behind the fronts of its triangles, and what is before them

    def __post_init__(self):
        self.low, self.high = self.corners.min(axis=(0, 1)), self.corners.max(axis=(0, 1))
        self.volume = np.linalg.det(self.corners - self.low).sum() / 6  # negative if its fronts face inwards

    def encloses(self, points):
        inside = ((points > self.low) & (points < self.high)).all(axis=1)
        inside[inside] = np.abs(winding_numbers(points[inside], self.corners)) > 0.5
        return inside


def winding_numbers(points, corners):
    """How often triangles surround each point, by the sum of their signed solid angles (van Oosterom and Strackee)."""
    a, b, c = np.moveaxis(corners - points[:, None, None], 2, 0)
    x, y, z = (np.linalg.norm(v, axis=2) for v in (a, b, c))
    products = x * y * z + (a * b).sum(axis=2) * z + (b * c).sum(axis=2) * x + (c * a).sum(axis=2) * y
    return np.arctan2((a * np.cross(b, c)).sum(axis=2), products).sum(axis=1) / (2 * np.pi)


def connected_parts(positions):
    """Indices of the triangles of each part, and whether it is closed. Parts have no corner in common."""
    corners = np.unique(positions.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)[1].reshape(-1, 3)
    labels, before = np.arange(corners.max() + 1), None
    while not np.array_equal(labels, before):
        before = labels.copy()
        np.minimum.at(labels, corners, labels[corners].min(axis=1)[:, None])
        labels = labels[labels]
    parts = np.unique(labels[corners[:, 0]], return_inverse=True)[1]
    edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    numbers = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)[1].ravel()
    is_open = np.bincount(numbers, np.sign(edges[:, 1] - edges[:, 0]))[numbers] != 0
    open_parts = set(np.repeat(parts, 3)[is_open])
    order = np.argsort(parts, kind="stable")
    found = np.split(order, np.flatnonzero(np.diff(parts[order])) + 1)
    return [(triangles, parts[triangles[0]] not in open_parts) for triangles in found]


def pierce(first, second):
    """Whether an edge of the first triangle of each pair meets the second one."""

    def sign(u, v, w):
        return np.sign((u * np.cross(v, w)).sum(axis=1))

    a, b, c = np.moveaxis(second, 1, 0)
    result = np.zeros(len(first), bool)
    for p, q in ((first[:, i - 1], first[:, i]) for i in range(3)):
        around = np.stack([sign(q - p, u - p, v - p) for u, v in ((a, b), (b, c), (c, a))])
        result |= (sign(b - a, c - a, p - a) != sign(b - a, c - a, q - a)) & (abs(around.sum(axis=0)) == abs(around).sum(axis=0))
    return result


class Bodies:
    def __init__(self, path, fog, positions, bodies):
        self.path, self.fog, self.bodies = path, fog, sorted(bodies, key=lambda body: -abs(body.volume))
        open_bodies = [body for body in self.bodies if body.is_open]
        if len(open_bodies) > MOST_OPEN:
            self.refuse(
                open_bodies[0],
                f"Mitsuba loses light behind more than {MOST_OPEN} open boundaries, and there are {len(open_bodies)}",
            )
        owners = np.full(len(positions), -1)
        for i, body in enumerate(self.bodies):
            owners[body.triangles] = i
            if not body.is_closed:
                self.refuse(body, "it is not closed, or a front meets a back there; close it")
        for i, body in enumerate(self.bodies):
            self._check_contacts(i, positions, owners)
        for i in range(len(self.bodies)):  # the largest first, so that what is around a cavity's glass is known
            self._find_sides(i)

    def medium_at(self, point):
        around = self._innermost(np.array([point], float))[0]
        return self._fog_at(point, point) if around < 0 else self.bodies[around].content

    def sides(self, count):
        """For each triangle of the scene the media behind and before it."""
        sides = [(None, None)] * count
        for body in self.bodies:
            for triangle in body.triangles:
                sides[triangle] = body.sides
        return sides

    def refuse(self, body, what):
        centre = ", ".join(f"{x:.4g}" for x in (body.low + body.high) / 2)
        raise UserError(f'{self.path}: references know no "medium" or "fog" at the boundary around ({centre}): {what}')

    def _innermost(self, points):
        found = np.full(len(points), -1)
        for i, body in enumerate(self.bodies):
            found[body.encloses(points)] = i
        return found

    def _fog_at(self, low, high, body=None):
        """The fog in a box, all of which is inside or outside of that of its grid."""
        if not self.fog or "density" not in self.fog:
            return self.fog
        begin, end = np.array(self.fog["box"], float)
        gap = 0 if body is None else TOUCHING * np.abs(np.array([low, high])).max()
        if (low > end + gap).any() or (high < begin - gap).any():
            return None
        if body is not None and ((low < begin + gap) | (high > end - gap)).any():
            self.refuse(body, 'it meets the "box" of the fog; move it, or change the "box"')
        return self.fog if ((low >= begin) & (high <= end)).all() else None

    def _check_contacts(self, index, positions, owners):
        body, scale = self.bodies[index], np.abs(positions).max(axis=(1, 2))
        for pairs in near_pairs(
            positions, body.triangles, (owners != index).nonzero()[0], TOUCHING * scale[body.triangles].max()
        ):
            first, second = positions[pairs[:, 0]], positions[pairs[:, 1]]
            touch = overlap(first, second, TOUCHING * scale[pairs].min(axis=1))
            other = owners[pairs[:, 1]] >= 0
            touch[other] |= pierce(first[other], second[other]) | pierce(second[other], first[other])
            if touch.any():
                place = ", ".join(f"{x:.4g}" for x in first[touch][0].mean(axis=0))
                self.refuse(body, f"it touches or overlaps something near ({place}); move them apart")

    def _find_sides(self, index):
        body = self.bodies[index]
        chosen = body.corners[:: max(1, len(body.corners) // ASKED)]
        offset = ASIDE * np.abs(body.corners).max() * triangle_normals(chosen)
        around = [self._innermost(chosen.mean(axis=1) + side * offset) for side in (-1, 1)]
        behind, before = (indices[0] for indices in around)
        if any((indices != indices[0]).any() for indices in around) or (behind == index) == (before == index):
            self.refuse(body, "it goes through itself; let the program that made it mend it")
        is_turned = before == index
        outside = behind if is_turned else before
        outer = self.bodies[outside] if outside >= 0 else None
        surroundings = outer.content if outer else self._fog_at(body.low, body.high, body)
        if is_turned and not body.is_open:
            if not outer or outer.is_open:
                self.refuse(body, "the faces of glass point inwards; turn them around")
            body.content = outer.sides[1] if outer.volume > 0 else outer.sides[0]  # a cavity
        body.sides = (surroundings, body.content) if is_turned else (body.content, surroundings)
