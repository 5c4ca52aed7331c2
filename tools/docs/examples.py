"""One step of an estimator in numbers, as the chapters' pages show it."""
from math import cos, degrees, pi, sin

from project import table
from report.numbers import short

ALBEDO = 0.8


def bounce_table():
    """A bounce of chapter 1."""
    u, before = (0.3, 0.4), 0.5
    theta, phi = pi / 2 * u[1], 2 * pi * u[0] - pi
    factor = pi**2 * (ALBEDO / pi) * cos(theta) * sin(theta)
    return table(["", "value"], [
        ["$u_x$, $u_y$ from the generator", f"{u[0]}, {u[1]}"],
        [r"$\theta = \frac{\pi}{2} u_y$", f"{short(theta)} ({degrees(theta):.0f}°)"],
        [r"$\varphi = 2\pi u_x - \pi$", f"{short(phi)} ({degrees(phi):.0f}°)"],
        [r"$\cos\theta$, $\sin\theta$", f"{short(cos(theta))}, {short(sin(theta))}"],
        [rf"$c = \pi^2 \frac{{a}}{{\pi}} \cos\theta \sin\theta$ with the albedo $a = {ALBEDO}$", short(factor)],
        [r"throughput $\beta$ before the bounce", short(before)],
        [r"throughput $\beta c$ after it", short(before * factor)],
    ])


def light_sample_table():
    """A light sample of chapter 3."""
    distance, cos_surface, cos_light, inverse_density, emission = 1.5, 0.9, 0.7, 0.25, 15.0
    geometry = cos_surface * cos_light / distance**2
    return table(["", "value"], [
        [r"distance $r$ from $x_k$ to $y$", short(distance)],
        [r"$n \cdot \omega$, $\cos\theta'$", f"{cos_surface}, {cos_light}"],
        [r"$(n \cdot \omega) \frac{\cos\theta'}{r^2}$", short(geometry)],
        [rf"$\rho = \frac{{a}}{{\pi}}$ with the albedo $a = {ALBEDO}$", short(ALBEDO / pi)],
        [r"$\frac{A}{P}$: area of the lamp, if there is only one", short(inverse_density)],
        [r"$L_e(y)$", short(emission)],
        ["the product, if nothing is between them", short(emission * ALBEDO / pi * geometry * inverse_density)],
        ["if something is", "0"],
    ])
