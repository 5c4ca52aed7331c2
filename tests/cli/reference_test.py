"""The materials that Mitsuba lacks, with numbers of Python in place of Mitsuba's: its scalar variant passes these, too."""

import importlib
import math
import sys
import unittest
from types import SimpleNamespace
from unittest import mock

import tools_path  # noqa: F401  (first: it finds the others)


def scalar_materials():
    """The classes that bsdfs.py registers, by name."""
    classes = {}
    drjit = SimpleNamespace(
        abs=abs,
        sqrt=math.sqrt,
        exp=math.exp,
        atanh=math.atanh,
        pi=math.pi,
        square=lambda x: x * x,
        minimum=min,
        maximum=max,
        select=lambda condition, yes, no: yes if condition else no,
        squared_norm=lambda v: v.x**2 + v.y**2 + v.z**2,
    )
    mitsuba = SimpleNamespace(BSDF=object, register_bsdf=classes.__setitem__, reflect=lambda w: Vector(-w.x, -w.y, w.z))
    with mock.patch.dict(sys.modules, {"drjit": drjit, "mitsuba": mitsuba}):
        importlib.import_module("references.bsdfs")
    return classes


class Vector(SimpleNamespace):
    def __init__(self, x, y, z):
        super().__init__(x=x, y=y, z=z)

    def __sub__(self, other):
        return Vector(self.x - other.x, self.y - other.y, self.z - other.z)


def direction(cosine, azimuth=0.0):
    sine = math.sqrt(1 - cosine**2)
    return Vector(sine * math.cos(azimuth), sine * math.sin(azimuth), cosine)


class MaterialsOfReferencesTest(unittest.TestCase):
    def correlation(self, alpha, cosine_in, cosine_out):
        glass = object.__new__(scalar_materials()["rough_glass"])
        glass.alpha = alpha
        return glass.correct(1.0, direction(cosine_in), direction(cosine_out))

    def test_masking_is_correlated_by_height(self):
        def term(alpha, cosine):  # Lambda of the GGX distribution
            return 0.5 * (math.sqrt(1 + alpha**2 * (1 / cosine**2 - 1)) - 1)

        for alpha, a, b in ((0.16, 1.0, 1.0), (0.16, 0.3, 0.9), (0.5, 0.01, 0.02), (0.9, -0.4, -0.2)):
            with self.subTest(alpha=alpha, a=a, b=b):
                first, second = term(alpha, a), term(alpha, b)
                expected = (1 + first) * (1 + second) / (1 + first + second)
                self.assertAlmostEqual(self.correlation(alpha, a, b), expected, delta=1e-12 * expected)

    def test_directions_in_the_surface_divide_by_no_zero(self):
        """As from a lamp in the same plane."""
        for a, b in ((0.0, 0.5), (0.5, 0.0), (0.0, 0.0)):
            self.assertEqual(self.correlation(0.16, a, b), 1)

    def test_a_phong_lobe_ends_behind_its_mirror_image(self):
        phong = object.__new__(scalar_materials()["phong_lobe"])
        phong.exponent = 20.0
        phong.lobe_albedos = lambda si, active: (0.0, 1.0, 1.0)
        for wi, wo, expected in (
            (direction(0.5), direction(0.5, math.pi), 22 / (2 * math.pi) * 0.5),  # the mirror image
            (direction(0.5), direction(0.5), 0),
            (direction(0), direction(0), 0),
        ):
            with self.subTest(wi=wi, wo=wo):
                value, _ = phong.eval_pdf(None, SimpleNamespace(wi=wi), wo, True)
                self.assertAlmostEqual(value, expected, delta=1e-5)
