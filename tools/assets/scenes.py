"""The scenes, a function each: lengths are in scene units, radiance in linear sRGB primaries."""
import math
from colorsys import hsv_to_rgb
from random import Random

from assets.files import camera, mesh, numbers, turn, write_light_probe, write_mesh, write_png, write_scene
from assets.shapes import (Part, add, box, cross, direction, dot, globe, normalize, quad, scale, smooth, sphere, subtract,
                           torus)

ROOM_MATERIALS = {
    "white": {"Kd": "0.74 0.73 0.71"}, "red": {"Kd": "0.62 0.12 0.1"}, "green": {"Kd": "0.16 0.46 0.13"},
    "light": {"Kd": "0.5 0.5 0.5", "Ke": "13.8 12.2 9.8"},
}


def room(floor="white", light=True):
    """A room of 2 x 2 x 2 with the floor at y = 0, centred at x = z = 0, open towards +Z. The light hangs
    0.01 below the ceiling: in the same plane it would depend on the backend which of the two a ray hits."""
    a, b, c, d = (-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)
    e, f, g, h = (add(p, (0, 2, 0)) for p in (a, b, c, d))
    parts = [quad(floor, [a, b, c, d]), quad("white", [e, h, g, f]), quad("white", [d, c, g, h]),
             quad("red", [a, d, h, e]), quad("green", [c, b, f, g])]
    if light:
        s, y = 0.3, 1.99
        parts.append(quad("light", [(-s, y, s), (-s, y, -s), (s, y, -s), (s, y, s)]))
    return parts


ROOM_CAMERA = camera([0, 1, 4], [0, 1, 0], 38)  # the room fills the picture but for a narrow rim


def cornell_box():
    # The boxes reach 0.02 below the floor, again to have no two surfaces in one plane.
    tall = box("white", (-0.36, 0.59, -0.32), (0.58, 1.22, 0.58), 17)
    short = box("white", (0.36, 0.28, 0.3), (0.58, 0.6, 0.58), -18)
    write_mesh("cornell_box", room() + tall + short, ROOM_MATERIALS)
    write_scene("cornell_box", "The Cornell box: two boxes between a red and a green wall, one ceiling light",
                [mesh("cornell_box")], ROOM_CAMERA)


def torus_scene():
    write_mesh("room", room(), ROOM_MATERIALS)
    write_mesh("torus", [torus("porcelain")], {"porcelain": {"Kd": "0.3 0.46 0.68"}})
    write_scene("torus", "A smooth torus of 7,680 triangles in the Cornell box",
                [mesh("room"), mesh("torus", scale=0.46, rotation=turn([1, -0.3, -0.45], 62),
                                    translation=[0, 0.84, 0])], ROOM_CAMERA)


def heart_radius(d):
    """Distance from the centre to Taubin's heart (x^2 + y^2 + 9/4 z^2 - 1)^3 = x^2 y^3 + 9/80 z^2 y^3 in the
    unit direction d. Along a ray it is a r^2 - 1 = b r^(5/3), which has one positive solution."""
    a = d[0]**2 + d[1]**2 + 9 / 4 * d[2]**2
    b = (d[0]**2 + 9 / 80 * d[2]**2)**(1 / 3) * d[1]
    low, high = 0, 2
    for _ in range(50):
        r = (low + high) / 2
        low, high = (r, high) if a * r * r - 1 < b * r**(5 / 3) else (low, r)
    return r


def heart_light():
    # Rings lie closest together at the cleft, where the surface is steep: areas differ by a factor of 1,600.
    def point(s, t):
        d = direction(math.pi * s**1.6, 2 * math.pi * t)
        return scale(heart_radius(d), d)

    # Of uniform radiance it would look flat: what faces the camera glows whiter, in steps.
    heart, steps = globe("", 72, 48, point), 16
    parts = [Part(f"glow_{k}") for k in range(steps)]
    materials = dict(ROOM_MATERIALS)
    for k, part in enumerate(parts):
        radiance = add((1.5, 0.12, 0.18), scale((k / (steps - 1))**1.5, (0.9, 0.82, 0.72)))
        materials[part.material] = {"Kd": "0.5 0.2 0.2", "Ke": numbers(radiance)}
    for triangle in heart.triangles:
        a, b, c = (heart.positions[v] for v in triangle)
        facing = abs(normalize(cross(subtract(b, a), subtract(c, a)))[2])
        part = parts[min(steps - 1, int(steps * facing))]
        part.triangles.append(tuple(len(part.positions) + k for k in range(3)))
        part.positions += [a, b, c]
    write_mesh("empty_room", room(light=False), materials)
    write_mesh("heart", parts, materials)
    write_mesh("sphere", [sphere("white")], materials)
    write_scene("heart_light", "A heart of 6,768 emissive triangles, very unequal in size, lights the room",
                [mesh("empty_room"), mesh("heart", scale=0.5, translation=[0, 1.16, 0.2]),
                 mesh("sphere", scale=0.3, translation=[-0.58, 0.29, -0.3]),
                 mesh("sphere", scale=0.22, translation=[0.62, 0.21, -0.1])], ROOM_CAMERA)


# Digits of three columns and five rows, row by row from the top.
DIGITS = ["111101101101111", "010110010010111", "111001111100111", "111001111001111", "101101111001001",
          "111100111001111", "111100111101111", "111001001001001", "111101111101111", "111101111001111"]


def numbered_squares(x, y):
    """8 x 8 squares of 32 x 32 pixels, each numbered by column (from the left) and row (from below)."""
    column, row = x // 32, 7 - y // 32
    dark = (column + row) % 2
    for k, digit in enumerate((column, row)):
        i, j = (x % 32 - 5 - 12 * k) // 3, (y % 32 - 8) // 3
        if 0 <= i < 3 and 0 <= j < 5 and DIGITS[digit][3 * j + i] == "1":
            return (0.85, 0.85, 0.82) if dark else (0.2, 0.2, 0.22)
    return hsv_to_rgb(column / 8, 0.6 if dark else 0.28, 0.55 if dark else 0.85)


def planks(x, y):
    """Four wooden planks of 50 pixels; the pattern continues across the borders of its 300 x 200 pixels."""
    plank, across = y // 50, y % 50
    along = (x + 97 * plank) % 300
    if across < 2 or along < 2:
        return (0.22, 0.15, 0.1)
    t = 2 * math.pi * along / 300
    grain = math.sin(0.5 * across + 3 * math.sin(t + 2 * plank) + 1.3 * math.sin(2 * t + plank))
    fine = math.sin(2.1 * across + 5 * math.sin(t) + 0.8 * math.sin(7 * t + plank))
    return scale((0.9 + 0.06 * (plank * 2 % 3 - 1)) * (1 + 0.07 * grain + 0.04 * fine), (0.76, 0.59, 0.42))


def panes(x, y):
    """96 x 160 pixels of coloured panes between dark bars."""
    white, red, yellow, blue = (0.84, 0.83, 0.79), (0.78, 0.2, 0.16), (0.86, 0.68, 0.2), (0.2, 0.34, 0.62)
    for left, top, right, bottom, paint in [
            (0, 0, 60, 50, white), (60, 0, 96, 90, red), (0, 50, 26, 112, blue), (26, 50, 60, 112, yellow),
            (60, 90, 96, 112, white), (0, 112, 70, 160, white), (70, 112, 96, 160, blue)]:
        if left + 2 <= x < right - 2 and top + 2 <= y < bottom - 2:
            return paint
    return (0.22, 0.22, 0.22)


def sky(d):
    """A clear sky over hazy ground, with a sun so broad and mild that uniform sampling converges."""
    sun = normalize((-0.62, 0.5, 0.45))
    glow = 18 * math.exp(40 * (dot(sun, d) - 1))
    up = max(0, d[1])**0.5
    above = tuple((1 - up) * horizon + up * zenith + glow * s
                  for horizon, zenith, s in zip((0.62, 0.7, 0.78), (0.1, 0.26, 0.7), (1, 0.86, 0.62)))
    ground = 1 / (1 + math.exp(200 * d[1]))  # a soft horizon
    return add(scale(1 - ground, above), scale(ground, (0.38, 0.33, 0.28)))


def textured():
    write_png("numbered_squares", 256, 256, numbered_squares)
    write_png("planks", 300, 200, planks)
    write_png("panes", 96, 160, panes)
    write_light_probe("sky", 256, 128, sky)
    materials = {name: {"Kd": "1 1 1", "map_Kd": f"../textures/{name}.png"}
                 for name in ("numbered_squares", "planks", "panes")}
    corners = [(-15, 0, 15), (15, 0, 15), (15, 0, -15), (-15, 0, -15)]
    write_mesh("wooden_floor", [quad("planks", corners, texture_size=(20, 30))], materials)
    write_mesh("paned_box", box("panes", (0, 0, 0), (0.6, 1, 0.6)), materials)
    ball = sphere("numbered_squares")
    ball.texture_coordinates = [(2 * u, v) for u, v in ball.texture_coordinates]  # twice around
    write_mesh("numbered_ball", [ball], materials)
    write_scene("textured", "A numbered ball, a paned box and a torus on a wooden floor under a light probe",
                [mesh("wooden_floor"), mesh("numbered_ball", scale=0.5, translation=[0.05, 0.49, 0.1]),
                 mesh("paned_box", rotation=turn([0, 1, 0], 24), translation=[-0.75, 0.49, -0.55]),
                 mesh("torus", scale=0.26, rotation=turn([1, 0, -0.35], 66), translation=[0.78, 0.33, -0.1])],
                camera([0.25, 1.25, 4.2], [0.02, 0.52, 0], 30),
                background={"light_probe": "../light_probes/sky.hdr"})


def pumpkin(grooves, height):
    """A pumpkin and its stem, 20,056 triangles. Twisted grooves and a bent stem: its mirror image differs."""
    def skin(s, t):
        theta, phi = math.pi * s, 2 * math.pi * t + 0.3 * math.cos(math.pi * s)
        x, y, z = direction(theta, phi)
        side = math.sin(theta)
        groove = side * (0.17 * math.cos(grooves / 2 * phi)**8 + 0.03 * math.sin(2 * phi + 1))
        dimple = 0.27 * math.exp(-(side / 0.35)**2) * y
        return ((1 - groove) * x, height * y * (1 - 0.4 * groove) - dimple, (1 - groove) * z)

    def stem(s, t):  # bent, wider towards its lower end inside the skin
        along = math.cos(math.pi / 2 * s)
        x, _, z = direction(math.pi / 2, 2 * math.pi * t)
        width = (0.1 + 0.12 * (1 - along)**2) * math.sqrt(math.sin(math.pi * s))
        width *= 1 + 0.12 * math.cos(10 * math.pi * t)
        return (width * x + 0.3 * along**3, height - 0.4 + 0.55 * along, width * z + 0.1 * along**2)

    return [smooth(globe("skin", 140, 70, skin)), smooth(globe("stem", 23, 17, stem))]


def instances():
    heights = {"orange": 0.74, "green": 0.6}
    write_mesh("orange_pumpkin", pumpkin(10, heights["orange"]),
               {"skin": {"Kd": "0.72 0.28 0.06"}, "stem": {"Kd": "0.3 0.34 0.14"}})
    write_mesh("green_pumpkin", pumpkin(14, heights["green"]),
               {"skin": {"Kd": "0.3 0.38 0.22"}, "stem": {"Kd": "0.42 0.34 0.2"}})
    grass = quad("grass", [(-40, 0, 40), (40, 0, 40), (40, 0, -40), (-40, 0, -40)])
    lamp = quad("lamp", [(-11, 5, 9), (-11, 5, 3), (-7, 10, 3), (-7, 10, 9)])  # above on the left
    write_mesh("field", [grass, lamp],
               {"grass": {"Kd": "0.3 0.34 0.17"}, "lamp": {"Kd": "0.5 0.5 0.5", "Ke": "17 14 9.5"}})

    random = Random(11)
    placed = []
    while len(placed) < 72:  # anywhere in view, as long as it touches none of the others
        z = 3.4 - 13 * random.random()
        x = 0.4 * (7 - z) * (2 * random.random() - 1)
        size = 0.26 + 0.5 * random.random()**2
        if all(math.hypot(x - other[0], z - other[1]) > 1.03 * (size + other[2]) for other in placed):
            placed.append((x, z, size))
    pumpkins = []
    for x, z, size in placed:
        kind = "orange" if random.random() < 0.65 else "green"
        mirror = 1 if random.random() < 0.5 else -1
        stretch, lean = 0.85 + 0.3 * random.random(), 0.2 * random.random()
        y = 0.72 * heights[kind] * stretch * size  # a little of it is in the ground
        pumpkins.append(mesh(f"{kind}_pumpkin", scale=[round(k * size, 3) for k in (mirror, stretch, 1)],
                             rotation=turn([round(lean, 3), 1, 0], round(360 * random.random())),
                             translation=[round(k, 3) for k in (x, y, z)]))
    write_scene("instances", "A field of pumpkins: 72 instances of two meshes, 1.4 million triangles",
                [mesh("field")] + pumpkins, camera([0, 2, 7], [0, 0.2, 0], 34),
                background={"radiance": [0.5, 0.66, 0.9]}, width=768, height=512)


def furnace():
    walls = box("grey", (0, 0, 0), (2, 2, 2))
    for wall in walls:
        wall.triangles = [triangle[::-1] for triangle in wall.triangles]  # facing inwards
    write_mesh("furnace", walls, {"grey": {"Kd": "0.5 0.5 0.5", "Ke": "1 1 1"}})
    write_scene("furnace", "A closed white furnace: albedo 0.5, emission 1, so 2 - 0.5^m at path length m",
                [mesh("furnace")], camera([0.3, 0.2, 0.6], [-0.4, -0.3, -1], 70))


def glossy():
    materials = {**ROOM_MATERIALS, "polished": {"Kd": "0.35 0.35 0.36", "Ks": "0.4 0.4 0.4", "Ns": "80"},
                 "gold": {"Kd": "0.25 0.16 0.05", "Ks": "0.6 0.44 0.18", "Ns": "40"},
                 "lacquer": {"Kd": "0.1 0.16 0.42", "Ks": "0.3 0.3 0.3", "Ns": "120"}}
    write_mesh("polished_room", room("polished"), materials)
    write_mesh("gold_ball", [sphere("gold")], materials)
    write_mesh("lacquer_torus", [torus("lacquer")], materials)
    write_scene("glossy", "A golden ball and a lacquered torus on a polished floor: the Phong lobe",
                [mesh("polished_room"), mesh("gold_ball", scale=0.42, translation=[-0.42, 0.41, -0.2]),
                 mesh("lacquer_torus", scale=0.3, rotation=turn([1, 0, 0.2], 70),
                      translation=[0.45, 0.4, 0.3])], ROOM_CAMERA, specular=True)


def glass():
    # All stay 0.01 above the floor: glass that touches another surface is neither inside nor outside there.
    materials = {"clear": {"Kd": "0 0 0", "d": "0", "Ni": "1.5"},
                 "teal": {"Kd": "0 0 0", "d": "0", "Ni": "1.5", "Tf": "0.08 0.5 0.62"}}
    write_mesh("clear_torus", [torus("clear")], materials)
    for name, what, paint in (("glass", "an absorbing", "teal"), ("clear_glass", "a clear", "clear")):
        write_mesh(f"{paint}_ball", [sphere(paint)], materials)
        write_scene(name, f"A clear torus and {what} ball of glass in the Cornell box",
                    [mesh("room"), mesh("clear_torus", scale=0.36, rotation=turn([1, -0.3, -0.3], 64),
                                        translation=[-0.36, 0.495, -0.2]),
                     mesh(f"{paint}_ball", scale=0.33, translation=[0.42, 0.34, 0.25])], ROOM_CAMERA)


def plates():
    """After Veach's test of multiple importance sampling: four lights of falling size and equal power above four plates
    of falling gloss. Each plate is turned so that its middle mirrors the lights into the camera."""
    position, height, radii, exponents = (0, 1.6, 9), 1.9, (0.6, 0.2, 0.066, 0.022), (60000, 4000, 500, 60)
    materials = {"grey": {"Kd": "0.42 0.42 0.44"}}
    floor = quad("grey", [(-9, -2.2, 6), (9, -2.2, 6), (9, -2.2, -2.5), (-9, -2.2, -2.5)])
    wall = quad("grey", [(-9, -2.2, -2.5), (9, -2.2, -2.5), (9, 6, -2.5), (-9, 6, -2.5)])
    parts = [floor, wall]
    for i, exponent in enumerate(exponents):
        name = f"plate_{i}"
        materials[name] = {"Kd": "0.06 0.065 0.07", "Ks": "0.55 0.55 0.55", "Ns": str(exponent)}
        centre = (0, -0.5 - 0.46 * i, -0.7 + 0.95 * i)
        to_light, to_camera = (normalize(subtract(p, centre)) for p in ((0, height, 0), position))
        normal = normalize(add(to_light, to_camera))
        along = scale(0.42, normalize(cross(normal, (1, 0, 0))))  # towards the camera
        side = (2.9 - 0.14 * i, 0, 0)
        parts.append(quad(name, [subtract(add(centre, along), side), add(add(centre, along), side),
                                 add(subtract(centre, along), side), subtract(subtract(centre, along), side)]))
    colours = (0.35, 0.75, 1), (0.6, 1, 0.55), (1, 0.85, 0.4), (1, 0.5, 0.4)
    for i, (radius, colour) in enumerate(zip(radii, colours)):
        name = f"light_{i}"
        materials[name] = {"Kd": "0 0 0", "Ke": numbers(scale(0.9 / radius**2, colour))}
        light = globe(name, 24, 12, lambda s, t: direction(math.pi * s, 2 * math.pi * t))
        light.texture_coordinates, light.texture_triangles = [], []
        light.positions = [add((-2.25 + 1.5 * i, height, 0), scale(radius, p)) for p in light.positions]
        parts.append(light)
    write_mesh("plates", parts, materials)
    write_scene("plates", "Four lights of falling size and equal power above four plates of falling gloss, after Veach",
                [mesh("plates")], camera(list(position), [0, -0.15, 0], 38), specular=True, width=768, height=512)


def clear_sky(d):
    """A clear sky with a small sun, 10^5 times as bright: its few texels bring half of the light."""
    up = max(0, d[1])**0.5
    above = tuple((1 - up) * horizon + up * zenith for horizon, zenith in zip((0.5, 0.6, 0.72), (0.08, 0.2, 0.55)))
    below = (0.2, 0.18, 0.15)
    blend = 1 / (1 + math.exp(-80 * d[1]))  # a soft horizon
    sky_radiance = add(scale(blend, above), scale(1 - blend, below))
    sun = normalize((-0.6, 0.55, 0.35))
    return add(sky_radiance, scale(2.2e4, (1, 0.9, 0.74))) if dot(sun, d) > math.cos(math.radians(0.75)) else sky_radiance


def sunny():
    write_light_probe("clear_sky", 512, 256, clear_sky)
    write_scene("sunny", "A torus, a ball and a pumpkin on a wooden floor under a clear sky with a small sun",
                [mesh("wooden_floor"), mesh("sphere", scale=0.45, translation=[0.72, 0.44, 0.3]),
                 mesh("torus", scale=0.34, rotation=turn([1, 0, -0.25], 68), translation=[-0.62, 0.47, 0]),
                 mesh("orange_pumpkin", scale=0.6, rotation=turn([0, 1, 0], 30), translation=[0.12, 0.42, -1])],
                camera([0.25, 1.3, 4.2], [0.02, 0.44, 0], 32),
                background={"light_probe": "../light_probes/clear_sky.hdr", "intensity": 0.6})


def softboxes(d):
    """A dark studio: a large softbox above on the left, a narrow one on the right, and a faint grey everywhere."""
    def softbox(centre, across, width, height):
        toward, right = normalize(centre), normalize(across)
        distance = dot(d, toward)
        if distance <= 0:
            return False
        point = scale(1 / distance, d)
        return abs(dot(point, right)) < width and abs(dot(point, cross(toward, right))) < height

    if softbox((-0.8, 0.75, 0.4), (0.4, 0, 0.8), 0.45, 0.3):
        return (14, 13.4, 12.6)
    if softbox((1, 0.35, 0.3), (0.3, 0, -1), 0.09, 0.5):
        return (17, 18.5, 21)
    return (0.03, 0.03, 0.032)


def studio():
    write_light_probe("softboxes", 256, 128, softboxes)
    write_mesh("grey_floor", [quad("floor", [(-6, 0, 6), (6, 0, 6), (6, 0, -6), (-6, 0, -6)])],
               {"floor": {"Kd": "0.3 0.3 0.31", "Ks": "0.25 0.25 0.25", "Ns": "300"}})
    write_scene("studio", "A golden ball and a lacquered torus in a studio with two softboxes",
                [mesh("grey_floor"), mesh("gold_ball", scale=0.5, translation=[-0.5, 0.49, -0.2]),
                 mesh("lacquer_torus", scale=0.34, rotation=turn([1, 0, 0.2], 70), translation=[0.55, 0.46, 0.3])],
                camera([0, 1.15, 4], [0.02, 0.42, 0], 32), specular=True,
                background={"light_probe": "../light_probes/softboxes.hdr"})


def still_life():
    """The picture at the head of the README: everything that the chapters know at once."""
    write_scene("still_life", "Glass, gold, lacquer, pumpkins and a glowing heart on a wooden floor under a mild sun",
                [mesh("wooden_floor"), mesh("heart", scale=0.5, translation=[0.25, 0.56, -0.75]),
                 mesh("teal_ball", scale=0.42, translation=[0.62, 0.43, 0.75]),
                 mesh("clear_torus", scale=0.42, rotation=turn([1, -0.25, -0.3], 62), translation=[-0.35, 0.6, 0.45]),
                 mesh("gold_ball", scale=0.36, translation=[-1.2, 0.35, 0.8]),
                 mesh("lacquer_torus", scale=0.3, rotation=turn([1, 0, 0.2], 8), translation=[-0.2, 0.12, 1.35]),
                 mesh("orange_pumpkin", scale=0.72, rotation=turn([0.05, 1, 0], 200), translation=[-1.7, 0.47, -0.6]),
                 mesh("orange_pumpkin", scale=0.45, rotation=turn([0.05, 1, 0], 70), translation=[1.42, 0.3, 0.85]),
                 mesh("green_pumpkin", scale=0.62, rotation=turn([0, 1, 0], 40), translation=[1.65, 0.34, -0.55])],
                camera([0.1, 1.25, 5.2], [0, 0.54, 0], 27), specular=True,
                background={"light_probe": "../light_probes/sky.hdr", "intensity": 1.6}, width=800, height=450)
