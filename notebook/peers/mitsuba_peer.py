"""Scenes in Mitsuba 3, by the translation that makes our references."""
from references.mitsuba_scene import MAX_BATCH_PATHS, dr, make_mitsuba_scene, mi, np  # isort: skip

from peers.renderers import GPU_VARIANT, Frame, timed

GPU_BATCH_PATHS = 1 << 26  # instead of MAX_BATCH_PATHS: they take about 4 GiB


class Renderer:
    def __init__(self, scene, options):
        self.scene, self.integrator = make_mitsuba_scene(
            scene, options.width, options.height, options.max_path_length, own_normals=True, sampler=options.sampler
        )
        self.name, self.discarded_seconds, self.compiled = f"Mitsuba {mi.__version__}", 0.0, set()  # numbers of samples
        self.largest = max(
            1, (GPU_BATCH_PATHS if mi.variant() == GPU_VARIANT else MAX_BATCH_PATHS) // (options.width * options.height)
        )
        glossy = any(surface.material.specular_albedo.any() for surface in scene.surfaces)
        self.note = "the Phong lobe is Python, which slows Mitsuba down" if glossy and mi.variant() == "scalar_rgb" else ""

    def frame(self, samples, seed):
        with timed() as clock:
            image = mi.render(self.scene, spp=samples, seed=seed % (1 << 32))
            if mi.variant() != "scalar_rgb":
                dr.eval(image)
                dr.sync_thread()
        return Frame(np.array(image, float), samples, clock.seconds, clock.cpu_seconds)

    def render(self, samples, seed):
        """About this many samples: most samplers round the number up, and need a kernel for each number. A first frame, which is
        discarded, compiles it."""
        sampler = self.scene.sensors()[0].sampler()
        sampler.set_sample_count(samples)
        count = sampler.sample_count()
        if count not in self.compiled:
            self.frame(count, seed)
            self.compiled.add(count)
            frame = self.frame(count, seed)
            self.discarded_seconds += frame.seconds  # of rendering alone: compiling is part of start-up
            return frame
        return self.frame(count, seed)
