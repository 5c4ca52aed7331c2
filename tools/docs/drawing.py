"""A drawing of lines and labels as SVG, and a view of three dimensions. It has no background: each colour is seen on white and on black."""
import math
import re
from xml.sax.saxutils import escape

import numpy as np

WIDTH = 640
GREY, BLUE, RED, GREEN, ORANGE, PURPLE = "#787d83", "#2f7de1", "#d64545", "#2c8f4e", "#b86e00", "#9b62d6"
SIZE = 16  # of text, in pixels


def number(value):
    return f"{round(float(value), 1) + 0.0:g}"  # + 0.0: there is one zero


def mix(a, b, t):
    """The point between a (t = 0) and b (t = 1)."""
    return a + t * np.subtract(b, a)


def beside(a, b, t, distance):
    """The point at this distance to the left of the way from a to b."""
    (x, y), length = mix(a, b, t), math.dist(a, b)
    return x + distance * (b[1] - a[1]) / length, y - distance * (b[0] - a[0]) / length


def along_edges(corners, count):
    """Points on the edges of a polygon, `count` an edge."""
    return [mix(a, b, i / count) for a, b in zip(corners, corners[1:] + corners[:1]) for i in range(count)]


def polar(centre, radius, degrees):
    """The point in this direction from the centre; 90 degrees is up."""
    angle = math.radians(degrees)
    return np.array(centre) + radius * np.array([math.cos(angle), -math.sin(angle)])


def curve(function, start, end, count=48):
    return [function(start + (end - start) * i / count) for i in range(count + 1)]


def pieces(text):
    """(text, is italic, shift in lines) of each part: $...$ is a formula, with _k or _{ij} below and ^k above the line."""
    for i, part in enumerate(text.split("$")):
        for shift, long, short, plain in re.findall(r"([_^])(?:\{(.*?)\}|(.))|([^_^]+)", part) if i % 2 else [("", "", "", part)]:
            if long or short or plain:
                yield long or short or plain, i % 2 == 1, {"_": 0.25, "^": -0.4, "": 0}[shift]


class Drawing:
    """All places are (x, y) in pixels from the upper left corner. Lines take points, closed ones may be filled."""

    def __init__(self, title, height, description):
        self.title, self.description, self.height, self.elements = title, description, height, []

    def line(self, points, colour=GREY, width=1.5, dashed=False, closed=False, fill=0):
        """`fill` is the opacity of the inside."""
        path = "M" + " L".join(f"{number(x)} {number(y)}" for x, y in points) + ("Z" if closed else "")
        inside = f'fill="{colour}" fill-opacity="{fill:g}"' if fill else 'fill="none"'
        dashes = ' stroke-dasharray="5 4"' if dashed else ""
        self.elements.append(f'<path d="{path}" {inside} stroke="{colour}" stroke-width="{number(width)}" stroke-linejoin="round"{dashes}/>')

    def polygon(self, points, colour, fill=0.25, width=1.5):
        self.line(points, colour, width, closed=True, fill=fill)

    def rectangle(self, corner, size, colour, fill=0.25, width=1.5):
        (x, y), (w, h) = corner, size
        self.polygon([(x, y), (x + w, y), (x + w, y + h), (x, y + h)], colour, fill, width)

    def arrow(self, points, colour=GREY, width=1.8, dashed=False):
        """A line with a head at its last point."""
        (x, y), (tip_x, tip_y) = points[-2:]
        angle = math.atan2(tip_y - y, tip_x - x)
        length, half = 7 + 1.5 * width, 2.5 + width

        def behind(along, across):
            return tip_x - along * math.cos(angle) - across * math.sin(angle), tip_y - along * math.sin(angle) + across * math.cos(angle)

        self.line([*points[:-1], behind(length - 1, 0)], colour, width, dashed)
        self.line([points[-1], behind(length, half), behind(length, -half)], colour, 0.5, closed=True, fill=1)

    def dot(self, at, colour=GREY, radius=3.5):
        self.elements.append(f'<circle cx="{number(at[0])}" cy="{number(at[1])}" r="{number(radius)}" fill="{colour}"/>')

    def camera(self, lens):
        x, y = lens
        self.rectangle((x - 26, y - 11), (22, 22), GREY)
        self.polygon([(x - 4, y - 4), (x + 6, y - 10), (x + 6, y + 10), (x - 4, y + 4)], GREY)

    def arc(self, centre, radius, start, end, colour):
        """Part of a circle between two directions in degrees, counterclockwise."""
        self.line(curve(lambda degrees: polar(centre, radius, degrees), start, end, 16), colour, 1.2)

    def label(self, at, text, colour=GREY, size=SIZE, anchor="middle"):
        """Text with its middle at this height; `anchor` says which end of it stands at this place: start, middle, end."""
        spans, shift_before = "", 0
        for piece, is_italic, shift in pieces(text):
            style = ' font-style="italic"' if is_italic else ""
            style += f' font-size="{number(0.7 * size)}"' if shift else ""
            style += f' dy="{number((shift - shift_before) * size)}"' if shift != shift_before else ""
            spans += f"<tspan{style}>{escape(piece)}</tspan>" if style else escape(piece)
            shift_before = shift
        x, y = number(at[0]), number(at[1] + 0.35 * size)
        self.elements.append(f'<text x="{x}" y="{y}" font-size="{number(size)}" fill="{colour}" text-anchor="{anchor}">{spans}</text>')

    def lines_of_text(self, at, lines, colour=GREY, size=SIZE, anchor="start"):
        for i, text in enumerate(lines):
            self.label(np.add(at, (0, 1.6 * i * size)), text, colour, size, anchor)

    def svg(self):
        size = f'viewBox="0 0 {WIDTH} {self.height}" width="{WIDTH}" height="{self.height}"'
        return "\n".join([
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" xml:space="preserve">',
            f"<title>{escape(self.title)}</title>", f"<desc>{escape(self.description)}</desc>", *self.elements, "</svg>", ""])


class View:
    """Looks at three dimensions, z up, from a direction given by azimuth and elevation in degrees; a unit has `scale` pixels."""

    def __init__(self, centre, scale, azimuth, elevation):
        self.centre, self.scale, self.azimuth = np.array(centre), scale, math.radians(azimuth)
        inclination = math.pi / 2 - math.radians(elevation)
        right, down = direction(math.pi / 2, self.azimuth + math.pi / 2), direction(inclination + math.pi / 2, self.azimuth)
        self.axes, self.toward = np.array([right, down]), direction(inclination, self.azimuth)

    def __call__(self, point):
        return self.centre + self.scale * self.axes @ point

    def path(self, function, start, end, count=48):
        """A curve in space on the drawing."""
        return [self(point) for point in curve(function, start, end, count)]

    def near_path(self, function, start, end, count=96):
        """A curve on the unit sphere, without what the sphere hides."""
        return [self(point) for point in curve(function, start, end, count) if self.toward @ point >= 0]


def direction(theta, phi):
    """The unit vector with inclination θ and azimuth φ, both in radians."""
    return np.array([math.cos(phi) * math.sin(theta), math.sin(phi) * math.sin(theta), math.cos(theta)])


def normalized(vector):
    return vector / np.linalg.norm(vector)
