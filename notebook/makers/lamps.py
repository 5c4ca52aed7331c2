"""A hall and a city with very many lamps: meshes for instances, and the scenes that place them. Seeded, so that they come out the same."""
import json
import math
import random

from makers.shapes import Part, add, cross, normalize, scale

POWERS = 10  # materials lamp_0 to lamp_9, of radiance 1:1000


def add_quad(part, *corners):
    first = len(part.positions)
    part.positions += corners
    part.triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]


def box(material, low, high):
    """A box seen from outside, without its bottom."""
    part, (a, b, c), (x, y, z) = Part(material), low, high
    add_quad(part, (a, y, z), (x, y, z), (x, y, c), (a, y, c))
    add_quad(part, (a, b, z), (x, b, z), (x, y, z), (a, y, z))
    add_quad(part, (x, b, c), (a, b, c), (a, y, c), (x, y, c))
    add_quad(part, (x, b, z), (x, b, c), (x, y, c), (x, y, z))
    add_quad(part, (a, b, c), (a, b, z), (a, y, z), (a, y, c))
    return part


def hall():
    """16 rooms of 4 x 4 x 3 with a doorway from each to the next ones."""
    floor, ceiling = Part("floor"), Part("wall")
    add_quad(floor, (0, 0, 16), (16, 0, 16), (16, 0, 0), (0, 0, 0))
    add_quad(ceiling, (0, 3, 0), (16, 3, 0), (16, 3, 16), (0, 3, 16))
    walls = []
    for i in range(5):
        for j in range(4):
            at, first = 4 * i, 4 * j
            ends = [(first, first + 4)] if i in (0, 4) else [(first, first + 1.4), (first + 2.6, first + 4)]
            for begin, end in ends:
                walls.append(box("wall", (at - 0.05, 0, begin), (at + 0.05, 3, end)))
                walls.append(box("red" if j % 2 else "blue", (begin, 0, at - 0.05), (end, 3, at + 0.05)))
    blocks = [
        box("floor", (4 * i + x, 0, 4 * j + z), (4 * i + x + 0.5, h, 4 * j + z + 0.5))
        for i in range(4)
        for j in range(4)
        for x, z, h in ((0.7, 0.8, 0.9), (2.7, 2.2, 1.3))
    ]
    return [floor, ceiling, *walls, *blocks]


def lamp_cluster():
    """128 small square lamps in a layer of 3 x 0.3 x 3 about the origin, turned all ways; the dimmest are the most frequent."""
    numbers = random.Random(14)
    parts = [Part(f"lamp_{i}") for i in range(POWERS)]
    for _ in range(128):
        centre = (numbers.uniform(-1.5, 1.5), numbers.uniform(-0.15, 0.15), numbers.uniform(-1.5, 1.5))
        normal = normalize(tuple(numbers.gauss(0, 1) for _ in range(3)))
        side = normalize(cross(normal, (0.3, 0.5, 0.8)))
        u, v = scale(0.02, side), scale(0.02, cross(normal, side))
        corners = [add(centre, add(scale(a, u), scale(b, v))) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        add_quad(parts[int(POWERS * numbers.random() ** 2)], *corners)
    return [part for part in parts if part.positions]


def building(floors, columns):
    """A tower of height 0.4 per floor, 0.4 wide per column: windows on all sides, each third one is lit."""
    numbers, width = random.Random(floors), 0.4 * columns
    lit = [Part("warm"), Part("cold"), Part("dim")]
    half = width / 2
    body = box("concrete", (-half, 0, -half), (half, 0.4 * floors, half))
    for side in range(4):
        cosine, sine = round(math.cos(math.pi / 2 * side)), round(math.sin(math.pi / 2 * side))
        for column in range(columns):
            for floor in range(floors):
                x, y = 0.4 * column - half + 0.1, 0.4 * floor + 0.12
                corners = [(x, y), (x + 0.2, y), (x + 0.2, y + 0.2), (x, y + 0.2)]
                turned = [(cosine * a + sine * (half + 0.01), b, -sine * a + cosine * (half + 0.01)) for a, b in corners]
                if numbers.random() < 0.4:
                    add_quad(lit[numbers.randrange(3)], *turned)
    return [body, *lit]


def street_lamp():
    """A lamp of 2 metres with a shade that faces down."""
    head = Part("lantern")
    add_quad(head, (-0.05, 0.95, -0.05), (0.05, 0.95, -0.05), (0.05, 0.95, 0.05), (-0.05, 0.95, 0.05))
    return [box("post", (-0.01, 0, -0.01), (0.01, 0.95, 0.01)), box("post", (-0.06, 0.96, -0.06), (0.06, 0.97, 0.06)), head]


def ground():
    part = Part("asphalt")
    add_quad(part, (-60, 0, 60), (60, 0, 60), (60, 0, -60), (-60, 0, -60))
    return [part]


def encode_scene(description, placements, camera, size):
    """One line for each instance."""
    lines = ",\n".join(f"        {json.dumps(placement)}" for placement in placements)
    width, height = size
    return (
        f'{{\n    "description": "{description}",\n    "meshes": [\n{lines}\n    ],\n    "camera": {json.dumps(camera)},\n'
        f'    "width": {width},\n    "height": {height}\n}}\n'
    ).encode()


def place(mesh, translation, degrees=0, factor=1):
    entry = {"file": f"../meshes/{mesh}.obj"}
    if factor != 1:
        entry["scale"] = factor
    if degrees:
        entry["rotation"] = {"axis": [0, 1, 0], "degrees": degrees}
    return entry | {"translation": [round(x, 3) for x in translation]}


def lamps_scene():
    placements = [{"file": "../meshes/hall.obj"}]
    placements += [place("lamp_cluster", (4 * i + 2, 2.6, 4 * j + 2), 90 * ((i + 3 * j) % 4)) for i in range(4) for j in range(4)]
    camera = {"position": [6.4, 1.5, 11.6], "target": [5.5, 1.25, 8], "up": [0, 1, 0], "vertical_fov": 60}
    return encode_scene("2,048 small lamps of radiance 1:1000 in 16 rooms, turned all ways", placements, camera, (512, 512))


def city_scene():
    numbers = random.Random(60)
    placements = [{"file": "../meshes/ground.obj"}]
    for i in range(-7, 8):
        for j in range(-7, 8):
            placements.append(
                place(
                    numbers.choice(["tower", "house"]),
                    (4 * i, 0, 4 * j),
                    90 * numbers.randrange(4),
                    numbers.choice([0.8, 1, 1.2]),
                )
            )
            placements.append(place("street_lamp", (4 * i + 1.9, 0, 4 * j + 1.9)))
    camera = {"position": [2, 1.6, 17], "target": [1.4, 1.3, 0], "up": [0, 1, 0], "vertical_fov": 50}
    return encode_scene(
        "A city at night: 225 buildings with lit windows, more than 100,000 emissive triangles", placements, camera, (512, 512)
    )
