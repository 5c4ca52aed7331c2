"""Diagrams of light: directions, densities, paths, glass. A function each; what can be computed is not placed by eye."""
import math

import numpy as np
from docs.drawing import (BLUE, GREEN, GREY, ORANGE, PURPLE, RED, Drawing, View, along_edges, beside, curve, direction, mix, normalized,
                          polar)

GLASS = 1.5  # refractive index


def circle_at(theta):
    """On the unit sphere at inclination θ, as a function of φ."""
    return lambda phi: direction(theta, phi)


def draw_hemisphere(drawing, view):
    """Draws the outline of a hemisphere and its base, whose far half is dashed."""
    near, base = view.azimuth - math.pi / 2, circle_at(math.pi / 2)
    drawing.line(view.path(base, near, near + math.pi), width=1.8)
    drawing.line(view.path(base, near + math.pi, near + 2 * math.pi), width=1.2, dashed=True)
    drawing.line(curve(lambda degrees: polar(view.centre, view.scale, degrees), 0, 180), width=1.8)


def hemisphere():
    drawing = Drawing(
        "Directions over a surface", 370,
        "A direction ω has the inclination θ and the azimuth φ. A small step in both covers the area sin θ dθ dφ of the "
        "unit sphere.")
    view = View((250, 270), 205, 30, 18)
    theta, phi, d_theta, d_phi = map(math.radians, (42, 62, 11, 18))
    omega, origin = direction(theta, phi), view((0, 0, 0))
    axis = (0, 0, omega[2])
    for end, name, offset in (((1.25, 0, 0), "x-axis", (-30, 0)), ((0, 1.25, 0), "y-axis", (32, 0)), ((0, 0, 1.25), "$n$", (-16, 6))):
        drawing.arrow([origin, view(end)])
        drawing.label(view(end) + offset, name)
    draw_hemisphere(drawing, view)
    drawing.line(view.path(circle_at(theta), 0, 2 * math.pi, 96), width=1, dashed=True)
    for azimuth in (phi, phi + d_phi):
        drawing.line(view.path(lambda t: direction(t, azimuth), 0, math.pi / 2), width=1, dashed=True)
        drawing.line([view(axis), view(direction(theta, azimuth))], GREEN)
        drawing.line([origin, view(direction(math.pi / 2, azimuth))], PURPLE, 1.2, dashed=True)
    corners = [(theta, phi), (theta, phi + d_phi), (theta + d_theta, phi + d_phi), (theta + d_theta, phi)]
    drawing.polygon([view(direction(*angles)) for angles in along_edges(corners, 12)], ORANGE, 0.55, 2)
    drawing.arrow([origin, view(omega)], BLUE, 2.6)
    drawing.line(view.path(lambda t: 0.42 * direction(t, phi), 0, theta), BLUE)
    drawing.line(view.path(lambda azimuth: 0.45 * direction(math.pi / 2, azimuth), 0, phi), PURPLE)
    drawing.label(view(0.53 * direction(theta / 2, phi)), "$θ$", BLUE, 18)
    drawing.label(view(0.6 * direction(math.pi / 2, phi * 0.55)), "$φ$", PURPLE, 18)
    drawing.label(view(0.7 * omega) + (15, 10), "$ω$", BLUE, 20)
    drawing.label(view(mix(axis, omega, 0.5)) + (-4, 15), "sin $θ$", GREEN, 14)
    for edge, text, place in ((mix(*corners[:2], 0.6), "sin $θ$ d$φ$", (480, 95)), (mix(*corners[1:3], 0.5), "d$θ$", (480, 150))):
        at = view(direction(*edge))
        drawing.line([mix(at, place, 0.03), (place[0] - 6, place[1])], ORANGE, 1)
        drawing.label(place, text, ORANGE, anchor="start")
    drawing.label((480, 222), "d$ω$ = sin $θ$ d$θ$ d$φ$", ORANGE, 15, anchor="start")
    drawing.dot(origin)
    return drawing


def cosine_projection():
    drawing = Drawing(
        "From the disk up to the hemisphere", 340,
        "Points that are uniform on a disk are moved straight up to the hemisphere. Cells of equal area become larger "
        "towards the rim. So the density of directions is cos θ / π.")
    view = View((235, 245), 205, 30, 26)
    rings, sectors = 5, 16
    radii = [math.sqrt(i / rings) for i in range(rings + 1)]  # rings of equal area
    angles = [2 * math.pi * i / sectors for i in range(sectors + 1)]
    behind = view.azimuth - math.pi  # where curves around the axis begin, so that what is seen is in one piece

    def flat(radius, phi):
        return radius * math.cos(phi), radius * math.sin(phi), 0

    def lifted(radius, phi):
        return direction(math.asin(min(radius, 1)), phi)

    for radius in radii[1:]:
        drawing.line(view.path(lambda phi: flat(radius, phi), 0, 2 * math.pi, 96), width=0.8)
        drawing.line(view.near_path(lambda phi: lifted(radius, phi), behind, behind + 2 * math.pi), BLUE, 0.8)
    for phi in angles[:-1]:
        drawing.line([view(flat(radii[1], phi)), view(flat(1, phi))], width=0.8)
        drawing.line(view.near_path(lambda theta: direction(theta, phi), math.asin(radii[1]), math.pi / 2), BLUE, 0.8)
    draw_hemisphere(drawing, view)
    for ring, sector, colour in ((1, 4, GREEN), (4, 15, ORANGE)):
        inner, outer, begin, end = *radii[ring:ring + 2], *angles[sector:sector + 2]
        corners = [(inner, begin), (inner, end), (outer, end), (outer, begin)]
        for surface in (flat, lifted):
            drawing.polygon([view(surface(*point)) for point in along_edges(corners, 24)], colour, 0.55, 1.6)
        for corner in corners:
            drawing.line([view(flat(*corner)), view(lifted(*corner))], colour, 1.2, dashed=True)
    drawing.lines_of_text((460, 60), ["Cells of the disk", "have equal areas:", "$p$($x$, $y$) = 1 / $π$"], size=15)
    drawing.lines_of_text((460, 155), ["Straight up:", "d$A$ = cos $θ$ d$ω$"], BLUE, 15)
    drawing.lines_of_text((460, 225), ["So directions have", "$p$($ω$) = cos $θ$ / $π$"], ORANGE, 15)
    return drawing


def path():
    drawing = Drawing(
        "A path and its throughput", 330,
        "A path from the camera hits the points x_1, x_2 and x_3. The throughput β is multiplied by a factor at each hit. "
        "Emitted radiance counts β times.")
    left, right, ceiling, floor = 120, 360, 40, 270
    points = [(35, 130), (215, floor), (right, 150), (262, ceiling + 6)]
    drawing.line([(left, floor), (right, floor), (right, ceiling), (left, ceiling)], width=2.5)
    drawing.rectangle((220, ceiling), (84, 6), ORANGE, 0.6)
    drawing.label((262, 22), "$L_e$ > 0", ORANGE)
    drawing.camera(points[0])
    for k, (colour, normal) in enumerate(((BLUE, None), (GREEN, (0, -1)), (PURPLE, (-1, 0)))):
        start, end = points[k:k + 2]
        if normal:
            drawing.arrow([start, start + 62 * np.array(normal)], GREY, 1.2, dashed=True)
            to_normal = math.degrees(math.atan2(-normal[1], normal[0]))
            to_end = math.degrees(math.atan2(start[1] - end[1], end[0] - start[0]))
            drawing.arc(start, 32, to_normal, to_end, colour)
            drawing.label(polar(start, 47, (to_normal + to_end) / 2), f"$θ_{k}$", colour, 14)
        drawing.arrow([start, end], colour, 2.4)
        drawing.label(beside(start, end, 0.55, -18 if k else 18), f"$ω_{k}$", colour, 18)
    for k, offset in enumerate(((0, 26), (0, 20), (22, 4), (-4, 20))):
        drawing.dot(points[k], ORANGE if k == 3 else GREY)
        drawing.label(np.add(points[k], offset), f"$x_{k}$", ORANGE if k == 3 else GREY, 18)
    drawing.label((400, 195), "$β_1$ = 1", BLUE, anchor="start")
    drawing.label((400, 225), "$β_2$ = $β_1$ · $ρ$ cos $θ_1$ / $p$($ω_1$)", GREEN, anchor="start")
    drawing.label((400, 255), "$β_3$ = $β_2$ · $ρ$ cos $θ_2$ / $p$($ω_2$)", PURPLE, anchor="start")
    drawing.label((320, 313), "radiance of the path = $β_1$ $L_e$($x_1$) + $β_2$ $L_e$($x_2$) + $β_3$ $L_e$($x_3$) + …", ORANGE)
    return drawing


def light_patch():
    drawing = Drawing(
        "The solid angle of a piece of a light", 310,
        "From x, the area dA around y at distance r, turned away by θ′, covers the solid angle dω = cos θ′ / r² dA.")
    view = View((185, 230), 112, 30, 20)
    x, y, up = np.array([(0, 0, 0), (0.35, 2.9, 1.85), (0, 0, 1)])
    omega, facing = normalized(y), normalized((0.1, -0.3, -1))  # the last is n′
    side = normalized(np.cross(facing, (0, 1, 0)))
    corners = [y + 0.42 * (i * side + j * np.cross(facing, side)) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]

    def turn(a, b, t):
        """Unit vectors from a (t = 0) to b (t = 1)."""
        return normalized(mix(a, b, t))

    drawing.polygon([view(point) for point in ((-1.15, -1.15, 0), (1.15, -1.15, 0), (1.15, 1.8, 0), (-1.15, 1.8, 0))], GREY, 0.08, 1)
    draw_hemisphere(drawing, view)
    for corner in corners:
        drawing.line([view(x), view(corner)], ORANGE, 1, dashed=True)
    drawing.polygon([view(corner) for corner in corners], ORANGE, 0.25)
    drawing.polygon([view(normalized(point)) for point in along_edges(corners, 12)], BLUE, 0.6)
    drawing.line([view(x), view(y)])
    drawing.arrow([view(x), view((0, 0, 1.35))])
    drawing.arrow([view(x), view(0.62 * omega)], BLUE, 2.4)
    drawing.arrow([view(y), view(y + 1.3 * facing)])
    drawing.line(view.path(lambda t: 0.42 * turn(up, omega, t), 0, 1), BLUE)
    drawing.line(view.path(lambda t: y + 0.75 * turn(facing, -omega, t), 0, 1), ORANGE)
    for place, text, colour, offset in (
            (0.55 * turn(up, omega, 0.45), "$θ$", BLUE, (0, 0)), (y + 0.95 * turn(facing, -omega, 0.35), "$θ$′", ORANGE, (0, 0)),
            ((0, 0, 1.35), "$n$", GREY, (-14, 4)), (y + 1.3 * facing, "$n$′", GREY, (-20, 2)),
            (x, "$x$", GREY, (-13, 8)), (y, "$y$", GREY, (14, -4)),
            (0.62 * omega, "$ω$", BLUE, (6, 17)), (0.75 * y, "$r$", GREY, (-4, -14)),
            (corners[0], "d$A$", ORANGE, (22, -2)), (omega, "d$ω$", BLUE, (-4, -30))):
        drawing.label(view(place) + offset, text, colour, 18)
    for point in (x, y):
        drawing.dot(view(point))
    drawing.label((510, 265), "d$ω$ = cos $θ$′ / $r$² · d$A$", size=18)
    return drawing


def splitting_tree():
    branches = 4
    drawing = Drawing(
        "Splitting", 300,
        f"One camera ray is traced, and {branches} branches go on from its first hit. Each of them counts 1/s.")
    camera, hit = (45, 140), (200, 140)
    bends = [((340, 40), (470, 62), (590, 30)), ((360, 105), (480, 128), (590, 92)),
             ((352, 172), (460, 150), (590, 176)), ((338, 240), (475, 222), (590, 246))]
    drawing.camera(camera)
    drawing.arrow([(camera[0] + 8, camera[1]), hit], BLUE, 3.2)
    for points, colour in zip(bends, (GREEN, ORANGE, PURPLE, RED)):
        for start, end in zip((hit, *points), points):
            drawing.arrow([start, end], colour, 1.8)
            drawing.dot(end, colour)
        drawing.label(beside(hit, points[0], 0.62, 14), "1/$s$", colour)
    drawing.dot(hit, BLUE, 4.5)
    drawing.label((hit[0] - 4, hit[1] + 22), "$x_1$", BLUE, 18)
    drawing.label((120, 112), "traced once", BLUE)
    drawing.label((95, 280), "one camera ray", BLUE, 15)
    drawing.label((425, 280), f"$s$ = {branches} branches with their own random numbers", size=15)
    return drawing


def roulette_tree():
    survival, bounces, widest = 0.7, 3, 14
    drawing = Drawing(
        "Russian roulette", 260,
        "At each bounce a path survives with probability q and is then worth 1/q of what it was. Else it ends and is "
        f"worth 0. The mean stays. Lines are as wide as their probability for q = {survival}.")
    places = [(110 + 150 * k, 85) for k in range(bounces + 1)]
    powers = ["1", "1/$q$", "1/$q$²", "1/$q$³"]
    for k, (start, end) in enumerate(zip(places, places[1:])):
        alive, bottom = survival**k, (start[0] + 90, 170)
        drawing.line([start, bottom], RED, widest * alive * (1 - survival))
        drawing.line([start, end], BLUE, widest * alive * survival)
        drawing.label((mix(start, end, 0.55)[0], 65), "$q$", BLUE)
        drawing.label(beside(start, bottom, 0.55, 34), "1 − $q$", RED)
        drawing.label((bottom[0], bottom[1] + 16), "0", RED, 18)
    for place, power in zip(places, powers):
        drawing.dot(place, BLUE, 6)
        drawing.label((place[0], 35), power, BLUE, 18)
    for place, mean in zip(places, ("1", "$q$ · 1/$q$ = 1", "$q$² · 1/$q$² = 1", "$q$³ · 1/$q$³ = 1")):
        drawing.label((place[0], 235), mean)
    drawing.label((15, 35), "weight", BLUE, anchor="start")
    drawing.label((15, 235), "mean", anchor="start")
    return drawing


def refraction():
    eta = 1 / GLASS
    drawing = Drawing(
        "Refraction and total reflection", 350,
        "Light leaves glass. Below the critical angle a part F is reflected and the rest is refracted as Snell's law "
        "says. Beyond it everything is reflected.")
    surface, length = 165, 115
    critical = math.degrees(math.asin(eta))
    for centre, inclination in ((165, 30), (475, 53)):
        at = (centre, surface)
        drawing.rectangle((centre - 145, surface), (290, 145), BLUE, 0.12, 0)
        drawing.line([(centre - 145, surface), (centre + 145, surface)], BLUE, 2.2)
        drawing.line([(centre, surface - 130), (centre, surface + 138)], dashed=True)
        drawing.line([at, polar(at, 140, 270 - critical)], ORANGE, 1, dashed=True)
        cosine, g2 = math.cos(math.radians(inclination)), eta**2 - math.sin(math.radians(inclination)) ** 2
        g = math.sqrt(max(g2, 0))
        share = ((cosine - g) ** 2 / (cosine + g) ** 2 + (eta**2 * cosine - g) ** 2 / (eta**2 * cosine + g) ** 2) / 2
        drawing.arrow([polar(at, length, 270 - inclination), at], RED, 3.2)
        drawing.arrow([at, polar(at, length, 270 + inclination)], RED, 1 + 2.2 * share)
        drawing.arc(at, 52, 270 - inclination, 270, RED)
        drawing.label(polar(at, 68, 270 - inclination / 2), "$θ$", RED, 18)
        if g2 > 0:
            refracted = math.degrees(math.asin(math.sin(math.radians(inclination)) / eta))
            drawing.arrow([at, polar(at, length, 90 - refracted)], RED, 1 + 2.2 * (1 - share))
            drawing.arc(at, 52, 90 - refracted, 90, RED)
            drawing.label(polar(at, 68, 90 - refracted / 2), "$θ_t$", RED, 18)
            drawing.label(polar(at, length + 26, 88 - refracted), "1 − $F$", RED)
        drawing.label(polar(at, length + 15, 270 + inclination), "$F$" if g2 > 0 else "$F$ = 1", RED)
    drawing.label((400, 290), "critical angle", ORANGE, 14)
    drawing.label((30, 22), "air", GREY, anchor="start")
    drawing.label((30, 190), "glass", BLUE, anchor="start")
    drawing.label((165, 335), "sin $θ$ < $η$:  sin $θ$ = $η$ sin $θ_t$")
    drawing.label((475, 335), "sin $θ$ > $η$:  total reflection")
    return drawing


def mis_weights():
    """In a plane: a lamp above spans some directions. A bounce takes either a lobe beside it or the cosine."""
    drawing = Drawing(
        "Weights of the balance heuristic", 400,
        "The density p_l of light samples and the density p_b of bounces along a line of directions. In every direction "
        "the weights w_l and w_b add up to one.")
    left, right, count, lamp_begin, lamp_end = 50, 600, 440, -0.05, 0.85
    angles = [math.pi * ((i + 0.5) / (count + 1) - 0.5) for i in range(count + 1)]
    # Uniform on the lamp: r / (cos θ′ · length) with respect to the angle, and r = 1 / cos θ′ at the height 1.
    lamp = [1 / math.cos(a) ** 2 / (lamp_end - lamp_begin) if lamp_begin <= math.tan(a) <= lamp_end else 0 for a in angles]
    lobe = [max(math.cos(a - 0.7), 0) ** 30 for a in angles]
    lobe_sum = sum(lobe) * math.pi / (count + 1)
    bounce = [0.6 * value / lobe_sum + 0.4 * math.cos(a) / 2 for a, value in zip(angles, lobe)]  # both have the integral 1
    weights = [p / (p + q) for p, q in zip(lamp, bounce)]
    xs = [left + (right - left) * i / count for i in range(count + 1)]
    base, tallest, bottom, unit = 175, 135 / max(*lamp, *bounce), 345, 115
    for values, colour in ((lamp, ORANGE), (bounce, BLUE)):
        points = [(x, base - tallest * value) for x, value in zip(xs, values)]
        drawing.polygon([(left, base), *points, (right, base)], colour, 0.18, 0)
        drawing.line(points, colour, 2)
    drawing.line([(left, base), (right, base)])
    border = [(x, bottom - unit * weight) for x, weight in zip(xs, weights)]
    drawing.polygon([(left, bottom), *border, (right, bottom)], ORANGE, 0.25, 0)
    drawing.polygon([(left, bottom - unit), *border, (right, bottom - unit)], BLUE, 0.2, 0)
    drawing.line(border, ORANGE)
    drawing.rectangle((left, bottom - unit), (right - left, unit), GREY, 0)
    for y, text in ((bottom - unit, "1"), (bottom, "0"), (base, "0")):
        drawing.label((left - 10, y), text, anchor="end", size=14)
    at = weights.index(max(weights))
    drawing.label((xs[at] - 10, 24), "$p_l$: light samples", ORANGE, anchor="end")
    drawing.label((xs[bounce.index(max(bounce))] + 45, 60), "$p_b$: bounces", BLUE, anchor="start")
    drawing.label((xs[at + 30], bottom - 28), "$w_l$", ORANGE, 18)
    drawing.label((150, bottom - unit / 2), "$w_b$", BLUE, 18)
    drawing.label((530, bottom - unit / 2), "$w_b$", BLUE, 18)
    drawing.label((right, 376), "direction $ω$", anchor="end", size=14)
    drawing.label((left, 376), "$w_l$ = $p_l$ / ($p_l$ + $p_b$),   $w_b$ = $p_b$ / ($p_l$ + $p_b$)", anchor="start")
    return drawing
