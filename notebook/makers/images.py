"""Textures and light probes by formula. A texture is a function of x and y, down from the top row, to sRGB; a light probe one of a
direction to linear radiance."""
import math
from colorsys import hsv_to_rgb

from makers.shapes import add, cross, dot, normalize, scale

# 3 x 5 pixel digits, row by row from the top.
DIGITS = [
    "111101101101111",
    "010110010010111",
    "111001111100111",
    "111001111001111",
    "101101111001001",
    "111100111001111",
    "111100111101111",
    "111001001001001",
    "111101111101111",
    "111101111001111",
]


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
        (0, 0, 60, 50, white),
        (60, 0, 96, 90, red),
        (0, 50, 26, 112, blue),
        (26, 50, 60, 112, yellow),
        (60, 90, 96, 112, white),
        (0, 112, 70, 160, white),
        (70, 112, 96, 160, blue),
    ]:
        if left + 2 <= x < right - 2 and top + 2 <= y < bottom - 2:
            return paint
    return (0.22, 0.22, 0.22)


def sky(d):
    """A clear sky over hazy ground, with a sun so broad and mild that uniform sampling converges."""
    sun = normalize((-0.62, 0.5, 0.45))
    glow = 18 * math.exp(40 * (dot(sun, d) - 1))
    up = max(0, d[1]) ** 0.5
    above = tuple(
        (1 - up) * horizon + up * zenith + glow * s
        for horizon, zenith, s in zip((0.62, 0.7, 0.78), (0.1, 0.26, 0.7), (1, 0.86, 0.62))
    )
    ground = 1 / (1 + math.exp(200 * d[1]))  # a soft horizon
    return add(scale(1 - ground, above), scale(ground, (0.38, 0.33, 0.28)))


def clear_sky(d):
    """A clear sky with a small sun, 10^5 times as bright: its few texels contribute half of the light."""
    up = max(0, d[1]) ** 0.5
    above = tuple((1 - up) * horizon + up * zenith for horizon, zenith in zip((0.5, 0.6, 0.72), (0.08, 0.2, 0.55)))
    below = (0.2, 0.18, 0.15)
    blend = 1 / (1 + math.exp(-80 * d[1]))  # a soft horizon
    sky_radiance = add(scale(blend, above), scale(1 - blend, below))
    sun = normalize((-0.6, 0.55, 0.35))
    return add(sky_radiance, scale(2.2e4, (1, 0.9, 0.74))) if dot(sun, d) > math.cos(math.radians(0.75)) else sky_radiance


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
