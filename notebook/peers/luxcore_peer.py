"""Scenes in LuxCore, the renderer of LuxCoreRender, as the module pyluxcore has it."""
import atexit
import os
import time

import numpy as np
import pyluxcore
from peers.renderers import Frame, timed
from peers.simple_scenes import corners, refuse_what_peers_lack

POLL = 0.005  # seconds between questions whether it is done: it renders on meanwhile


def properties(values):
    made = pyluxcore.Properties()
    for name, value in values.items():
        made.Set(pyluxcore.Property(name, value))
    return made


def floats(values):
    return [float(value) for value in values]


def material_properties(name, material):
    if material.refractive_index > 0:
        values = {"type": "glass", "kr": [1.0] * 3, "kt": [1.0] * 3, "interiorior": material.refractive_index, "exteriorior": 1.0}
    else:
        values = {"type": "matte", "kd": floats(material.diffuse_albedo)}
    if material.emission.any():
        # By itself LuxCore leaves lamps of many triangles to chance.
        values |= {"emission": floats(material.emission), "emission.directlightsampling.type": "ENABLED"}
    return {f"scene.materials.{name}.{key}": value for key, value in values.items()}


def make_scene(scene, options):
    made, camera, aspect = pyluxcore.Scene(), scene.camera, options.width / options.height
    pixel = 2 / options.height  # LuxCore's pictures are a pixel too low
    made.Parse(
        properties(
            {
                "scene.camera.type": "perspective",
                "scene.camera.fieldofview": float(camera["vertical_fov"]),
                "scene.camera.screenwindow": [-aspect, aspect, -1 - pixel, 1 - pixel],
                "scene.camera.lookat.orig": floats(camera["position"]),
                "scene.camera.lookat.target": floats(camera["target"]),
                "scene.camera.up": floats(camera["up"]),
            }
        )
    )
    if scene.fog:
        albedo, extinction = np.broadcast_to(scene.fog["albedo"], 3), scene.fog["extinction"]
        made.Parse(
            properties(
                {
                    "scene.volumes.fog.type": "homogeneous",
                    "scene.volumes.fog.scattering": floats(extinction * albedo),
                    "scene.volumes.fog.absorption": floats(extinction * (1 - albedo)),
                    "scene.volumes.fog.asymmetry": floats([scene.fog["anisotropy"]] * 3),
                    "scene.volumes.fog.multiscattering": True,
                    "scene.world.volume.default": "fog",
                }
            )
        )
    for number, surface in enumerate(scene.surfaces):
        name = f"surface_{number}"
        points, triangles, normals = (values and list(map(tuple, values)) for values in corners(surface))
        made.DefineMesh(name, points, triangles, normals, None, None, None)
        made.Parse(
            properties(
                {
                    **material_properties(name, surface.material),
                    f"scene.objects.{name}.shape": name,
                    f"scene.objects.{name}.material": name,
                }
            )
        )
    return made


class Renderer:
    note, largest, discarded_seconds = "", 1 << 16, 0.0

    def __init__(self, scene, options):
        refuse_what_peers_lack(scene, "LuxCore")
        pyluxcore.Init(lambda message: None)
        atexit.register(pyluxcore.SetLogHandler, None)  # or it calls the handler when Python has ended
        self.name, self.integrator, self.pixels = f"LuxCore {pyluxcore.Version()}", "PATHCPU", (options.height, options.width, 3)
        self.scene, sampler = make_scene(scene, options), options.sampler.upper()
        depth = options.max_path_length + 1  # LuxCore counts segments
        self.settings = {
            "renderengine.type": "PATHCPU",
            "sampler.type": sampler,
            f"sampler.{options.sampler}.adaptive.strength": 0.0,
            "native.threads.count": len(os.sched_getaffinity(0)),
            "path.clamping.variance.maxvalue": 0.0,
            **{f"path.pathdepth.{kind}": depth for kind in ("total", "diffuse", "glossy", "specular")},
            # No roulette: its probabilities in LuxCore's two MIS weights differ, so that their sum is not 1.
            "path.russianroulette.depth": depth + 1,
            "film.width": options.width,
            "film.height": options.height,
            "film.filter.type": "NONE",
            "film.outputs.0.type": "RGB",
            "film.outputs.0.filename": "unused.exr",
        }

    def render(self, samples, seed):
        settings = properties(self.settings | {"batch.haltspp": samples, "renderengine.seed": seed % (1 << 31) + 1})
        session = pyluxcore.RenderSession(pyluxcore.RenderConfig(settings, self.scene))
        with timed() as clock:
            session.Start()
            while not session.HasDone():
                time.sleep(POLL)
                session.UpdateStats()
            session.Stop()
        pixels = np.empty(self.pixels, np.float32)
        session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0)
        # All threads render on until one sees the end, so that a few samples more are taken.
        taken = session.GetStats().Get("stats.renderengine.total.samplecount").GetFloat() / (self.pixels[0] * self.pixels[1])
        return Frame(pixels[::-1].astype(float), taken, clock.seconds, clock.cpu_seconds)  # the first row is the lowest
