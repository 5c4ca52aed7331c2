"""Triangle meshes by formula, and the vectors that they are made of: +Y is up, triangles are counter-clockwise seen from
their front."""
import math
from dataclasses import dataclass, field


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def scale(s, a):
    return tuple(s * x for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def normalize(a):
    return scale(1 / math.hypot(*a), a)


def direction(theta, phi):
    """Unit vector; theta from +Y, phi from +Z towards +X, both in radians."""
    return (math.sin(theta) * math.sin(phi), math.cos(theta), math.sin(theta) * math.cos(phi))


@dataclass
class Part:
    """Triangles of one material. Normals, if any, correspond to positions; texture coordinates have their own triangles, because
    a texture has a seam where the surface has none."""

    material: str
    positions: list = field(default_factory=list)
    triangles: list = field(default_factory=list)
    normals: list = field(default_factory=list)
    texture_coordinates: list = field(default_factory=list)
    texture_triangles: list = field(default_factory=list)
    times_around: int = 0  # of the texture; 0 without one


def globe(material, columns, rows, point):
    """A closed surface like a globe: point(s, t) with s from 0 (north pole) to 1 (south pole), t from 0 to 1.
    Texture coordinates are (t, 1 - s); at a pole each triangle has its own, in the middle of its t."""
    rings = [point(i / rows, j / columns) for i in range(1, rows) for j in range(columns)]
    part = Part(material, [point(0, 0), *rings, point(1, 0)])
    part.texture_coordinates = [(j / columns, 1 - i / rows) for i in range(1, rows) for j in range(columns + 1)]
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


def sphere(material, times_around=0, columns=64):
    """The unit sphere."""
    part = globe(material, columns, columns // 2, lambda s, t: direction(math.pi * s, 2 * math.pi * t))
    part.times_around = times_around
    part.normals = part.positions
    return part


def rounded_cylinder(material, columns=64, rows=48, power=0.25):
    """A cylinder about the Y axis with round edges, of radius and half height 1: a sphere whose sine and cosine have that power."""

    def curve(s, exponent):
        return math.sin(math.pi * s) ** exponent, math.copysign(abs(math.cos(math.pi * s)) ** exponent, math.cos(math.pi * s))

    def around(t, radius, height):
        return (radius * math.sin(2 * math.pi * t), height, radius * math.cos(2 * math.pi * t))

    part = globe(material, columns, rows, lambda s, t: around(t, *curve(s, power)) if 0 < s < 1 else (0, 1 - 2 * s, 0))
    normals = globe(material, columns, rows, lambda s, t: around(t, *curve(s, 2 - power)) if 0 < s < 1 else (0, 1 - 2 * s, 0))
    part.normals = [normalize(normal) for normal in normals.positions]
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


def row_of_balls(materials, radius, distance, z):
    """A row of balls of these materials, from left to right, on the floor."""
    parts = [sphere(material, columns=48) for material in materials]
    for i, part in enumerate(parts):
        centre = (distance * (i - (len(parts) - 1) / 2), radius, z)
        part.positions = [add(centre, scale(radius, position)) for position in part.positions]
    return parts


def smooth(part):
    """The same part with vertex normals: the mean of the adjacent triangles' normals, weighted by their angles."""
    sums = [(0, 0, 0)] * len(part.positions)
    for triangle in part.triangles:
        corners = [part.positions[v] for v in triangle]
        for i, vertex in enumerate(triangle):
            a, b = (normalize(subtract(corners[(i + k) % 3], corners[i])) for k in (1, 2))
            angle = math.acos(max(-1, min(1, dot(a, b))))
            sums[vertex] = add(sums[vertex], scale(angle, normalize(cross(a, b))))
    part.normals = [normalize(n) for n in sums]
    return part


def heart_radius(d):
    """Distance from the centre to Taubin's heart (x^2 + y^2 + 9/4 z^2 - 1)^3 = x^2 y^3 + 9/80 z^2 y^3 in the
    unit direction d. Along a ray it is a r^2 - 1 = b r^(5/3), which has one positive solution."""
    a = d[0] ** 2 + d[1] ** 2 + 9 / 4 * d[2] ** 2
    b = (d[0] ** 2 + 9 / 80 * d[2] ** 2) ** (1 / 3) * d[1]
    low, high = 0, 2
    for _ in range(50):
        r = (low + high) / 2
        low, high = (r, high) if a * r * r - 1 < b * r ** (5 / 3) else (low, r)
    return r


def heart():
    """A heart in parts glow_0 to glow_15: triangles that face +Z glow whiter, in 16 steps. Rings lie closest together at the cleft, where
    the surface is steep: areas differ by a factor of 1,600."""

    def point(s, t):
        d = direction(math.pi * s**1.6, 2 * math.pi * t)
        return scale(heart_radius(d), d)

    whole, steps = globe("", 72, 48, point), 16
    parts = [Part(f"glow_{k}") for k in range(steps)]
    for triangle in whole.triangles:
        a, b, c = (whole.positions[v] for v in triangle)
        facing = abs(normalize(cross(subtract(b, a), subtract(c, a)))[2])
        part = parts[min(steps - 1, int(steps * facing))]
        part.triangles.append(tuple(len(part.positions) + k for k in range(3)))
        part.positions += [a, b, c]
    return parts


def pumpkin(grooves, height):
    """A pumpkin and its stem, 20,056 triangles. Its grooves are twisted and its stem is bent, so its mirror image differs."""

    def skin(s, t):
        theta, phi = math.pi * s, 2 * math.pi * t + 0.3 * math.cos(math.pi * s)
        x, y, z = direction(theta, phi)
        side = math.sin(theta)
        groove = side * (0.17 * math.cos(grooves / 2 * phi) ** 8 + 0.03 * math.sin(2 * phi + 1))
        dimple = 0.27 * math.exp(-((side / 0.35) ** 2)) * y
        return ((1 - groove) * x, height * y * (1 - 0.4 * groove) - dimple, (1 - groove) * z)

    def stem(s, t):  # bent, wider towards its lower end inside the skin
        along = math.cos(math.pi / 2 * s)
        x, _, z = direction(math.pi / 2, 2 * math.pi * t)
        width = (0.1 + 0.12 * (1 - along) ** 2) * math.sqrt(math.sin(math.pi * s))
        width *= 1 + 0.12 * math.cos(10 * math.pi * t)
        return (width * x + 0.3 * along**3, height - 0.4 + 0.55 * along, width * z + 0.1 * along**2)

    return [smooth(globe("skin", 140, 70, skin)), smooth(globe("stem", 23, 17, stem))]
