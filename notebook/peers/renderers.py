"""The renderers that chapters are compared with: their packages, and the settings that are measured.

Imports only what every Python has. NAME_peer.py defines a class Renderer:

    Renderer(scene, options)   opens a scene that references/scenes.py has read, or raises UserError if it cannot render it.
                               options: width, height, max_path_length, variant, sampler
    render(samples, seed)      one picture: a Frame
    name, integrator, note     for the report
    discarded_seconds          of renders that only prepared others, such as those that compiled a kernel
    largest                    the most samples of a frame
"""
import os
import time
from contextlib import contextmanager
from typing import NamedTuple

from project import ROOT, VARIANTS

FOLDER = ROOT / "output/peers"  # of what ./lab notebook install_peer installs
# The measured version of each. numpy is for us.
PACKAGES = {"mitsuba": ["mitsuba==3.9.1", "numpy"], "cycles": ["bpy==5.0.1", "numpy"], "luxcore": ["pyluxcore==2.11.2", "numpy"]}
PYTHON = "python3.11"  # for which all of these versions exist; bpy has no other
GPU_VARIANT = "cuda_ad_rgb"
CPU_VARIANTS = [variant for variant in VARIANTS if variant != GPU_VARIANT]
SAMPLERS = ["independent", "stratified", "multijitter", "orthogonal", "ldsampler"]  # of Mitsuba
# Values of --sampler, the default first. Cycles always takes Sobol points; this is how it chooses a light.
SETTINGS = {"mitsuba": SAMPLERS, "cycles": ["light_tree", "no_light_tree"], "luxcore": ["sobol", "random"]}


class Frame(NamedTuple):
    image: object  # array [row, column, channel] of linear radiance
    samples: int  # per pixel that were taken: some renderers round them up
    seconds: float  # of rendering, by the clock on the wall
    cpu_seconds: float  # of all threads


class Clock:
    """Seconds of a `with timed()`."""

    seconds = cpu_seconds = 0.0


@contextmanager
def timed():
    clock, started, cpu_started = Clock(), time.perf_counter(), time.process_time()
    yield clock
    clock.seconds, clock.cpu_seconds = time.perf_counter() - started, time.process_time() - cpu_started


def renderer_of(variant):
    """The renderer of a --variant."""
    return "mitsuba" if variant in VARIANTS else variant


def python_of(renderer):
    """The Python that has a renderer. Mitsuba is the user's own, such as that of an active virtual environment."""
    return "python3" if renderer == "mitsuba" else os.path.relpath(FOLDER / renderer / "bin/python", ROOT)
