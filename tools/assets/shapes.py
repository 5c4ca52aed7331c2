"""Triangle meshes by formula, and the vectors that they are made of: +Y is up, triangles are counter-clockwise seen from
their front."""
import math
from dataclasses import dataclass, field


def add(a, b): return tuple(x + y for x, y in zip(a, b))
def subtract(a, b): return tuple(x - y for x, y in zip(a, b))
def scale(s, a): return tuple(s * x for x in a)
def dot(a, b): return sum(x * y for x, y in zip(a, b))
def cross(a, b): return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
def normalize(a): return scale(1 / math.hypot(*a), a)


def direction(theta, phi):
    """Unit vector; theta from +Y, phi from +Z towards +X, both in radians."""
    return (math.sin(theta) * math.sin(phi), math.cos(theta), math.sin(theta) * math.cos(phi))


def rotate_y(degrees, a):
    """Rotates counter-clockwise seen from above."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return (c * a[0] + s * a[2], a[1], c * a[2] - s * a[0])


@dataclass
class Part:
    """Triangles of one material. Normals, if any, go with positions; texture coordinates have triangles of
    their own, because a texture has a seam where the surface has none."""
    material: str
    positions: list = field(default_factory=list)
    triangles: list = field(default_factory=list)
    normals: list = field(default_factory=list)
    texture_coordinates: list = field(default_factory=list)
    texture_triangles: list = field(default_factory=list)


def quad(material, corners, texture_size=(1, 1)):
    """Two triangles; corners counter-clockwise from the front. The first is at texture coordinates (0,0), the
    second along +u, the third at texture_size."""
    (u, v), triangles = texture_size, [(0, 1, 2), (0, 2, 3)]
    return Part(material, corners, triangles, [], [(0, 0), (u, 0), (u, v), (0, v)], triangles)


def box(material, centre, size, degrees=0):
    """A closed box facing outwards, turned about the vertical through its centre: six quads."""
    faces = []
    for axis, side in [(a, s) for a in range(3) for s in (-1, 1)]:
        # The up of an upright face is +Y, so that its texture stands upright.
        up = (0, 0, -side) if axis == 1 else (0, 1, 0)
        outwards = tuple(side if i == axis else 0 for i in range(3))
        right = cross(up, outwards)  # as seen from outside
        corners = [add(outwards, add(scale(s, right), scale(t, up)))
                   for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        sized = [tuple(x * s / 2 for x, s in zip(corner, size)) for corner in corners]
        faces.append(quad(material, [add(centre, rotate_y(degrees, corner)) for corner in sized]))
    return faces


def globe(material, columns, rows, point):
    """A closed surface like a globe: point(s, t) with s from 0 (north pole) to 1 (south pole), t from 0 to 1.
    Texture coordinates are (t, 1 - s); at a pole each triangle has its own, in the middle of its t."""
    rings = [point(i / rows, j / columns) for i in range(1, rows) for j in range(columns)]
    part = Part(material, [point(0, 0), *rings, point(1, 0)])
    part.texture_coordinates = [(j / columns, 1 - i / rows)
                                for i in range(1, rows) for j in range(columns + 1)]
    part.texture_coordinates += [((j + 0.5) / columns, v) for v in (1, 0) for j in range(columns)]  # poles

    def vertex(i, j):
        return 0 if i == 0 else len(rings) + 1 if i == rows else 1 + (i - 1) * columns + j % columns

    def texture_vertex(i, j, column):
        if 0 < i < rows:
            return (i - 1) * (columns + 1) + j
        return (rows - 1) * (columns + 1) + (columns if i == rows else 0) + column

    def add_triangle(*corners, column):
        part.triangles.append(tuple(vertex(i, j) for i, j in corners))
        part.texture_triangles.append(tuple(texture_vertex(i, j, column) for i, j in corners))

    for i in range(rows):
        for j in range(columns):
            if i < rows - 1:
                add_triangle((i, j), (i + 1, j), (i + 1, j + 1), column=j)
            if i > 0:
                add_triangle((i, j), (i + 1, j + 1), (i, j + 1), column=j)
    return part


def sphere(material):
    """The unit sphere."""
    part = globe(material, 64, 32, lambda s, t: direction(math.pi * s, 2 * math.pi * t))
    part.normals = part.positions
    return part


def torus(material):
    """A torus about the Y axis: a tube of radius 0.42 around the circle of radius 1."""
    part, columns, rows = Part(material), 96, 40
    for i in range(columns):
        for j in range(rows):
            around, tube = direction(math.pi / 2, 2 * math.pi * i / columns), 2 * math.pi * j / rows
            normal = add(scale(math.cos(tube), around), (0, math.sin(tube), 0))
            part.positions.append(add(around, scale(0.42, normal)))
            part.normals.append(normal)
            a, b = i * rows + j, i * rows + (j + 1) % rows
            c, d = (a + rows) % (columns * rows), (b + rows) % (columns * rows)
            part.triangles += [(a, c, d), (a, d, b)]
    return part


def smooth(part):
    """The same part with normals: the mean of the triangles at a vertex, weighted by their angles."""
    sums = [(0, 0, 0)] * len(part.positions)
    for triangle in part.triangles:
        corners = [part.positions[v] for v in triangle]
        for i, vertex in enumerate(triangle):
            a, b = (normalize(subtract(corners[(i + k) % 3], corners[i])) for k in (1, 2))
            angle = math.acos(max(-1, min(1, dot(a, b))))
            sums[vertex] = add(sums[vertex], scale(angle, normalize(cross(a, b))))
    part.normals = [normalize(n) for n in sums]
    return part
