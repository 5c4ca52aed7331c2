#!/usr/bin/env python3
"""Renders reference images of our scenes with Mitsuba 3, a renderer that shares no code with ours.

    ./lab reference SCENE --output FILE.exr   renders one scene, also one of your own
    ./lab reference --all                     renders those of the list below that assets/references lacks

A reference is an EXR file with the mean of all samples in R, G and B, the variance of that mean, estimated from
independent batches, in variance.R, variance.G and variance.B, and how it came about as attributes. Path lengths
count as in the chapters: at most m bounces are Mitsuba's max_depth m + 1. Nothing is decided by Russian roulette.

Mitsuba is needed to make references only (`pip install mitsuba`; made and tested with version 3.9.1). Its variant
scalar_rgb runs everywhere, but is slow where vertex normals are interpolated or the Phong lobe is used, as that is
Python here; llvm_ad_rgb compiles it for the CPU (LLVM 19 or newer, DRJIT_LIBLLVM_PATH names its library) and
cuda_ad_rgb for NVIDIA's GPUs.
"""
import math
import signal
import sys
import time
from pathlib import Path

try:
    import numpy as np
    from command_line import Parser
    from exr_file import read_attributes, write_exr
    from progress import show_progress
    from scene_reader import UserError, read_scene
    import drjit as dr
    import mitsuba as mi
except ImportError as error:
    sys.exit(f"error: {error}: this needs Mitsuba 3: `pip install mitsuba`, in a virtual environment that is active here")

ROOT = Path(__file__).resolve().parent.parent

# The references that the tests use: scene, maximal path length, samples a pixel; all 128 x 128 pixels, seed 1.
SHIPPED = [
    ("cornell_box", 1, 65536),
    ("cornell_box", 6, 65536),
    ("torus", 5, 65536),
    ("heart_light", 4, 65536),
    ("textured", 4, 65536),
    ("glossy", 5, 65536),
    ("instances", 4, 65536),
    ("glass", 8, 65536),
    ("check_room", 2, 65536),
    ("check_room", 6, 65536),
    ("check_glass", 8, 65536),
]
SHIPPED_SIZE = 128

BATCHES = 64  # for the variance of the mean: known to 18 %
MIN_BATCHES = 32  # of an interrupted render
MAX_BATCH_PATHS = 1 << 24  # so that a batch fits into memory and ends in reasonable time


# ---------------------------------------------------------------------------------------------- materials
def define_bsdfs():
    """Mitsuba's base class exists once the variant is chosen."""

    class InterpolatedNormals(mi.BSDF):
        """Another BSDF in the frame of interpolated normals, which the mesh has as attribute vertex_shading_normal.

        Mitsuba's own vertex normals also turn the front of emitters and the area of light sources. Ours shade only:
        a direction on opposite sides of the interpolated normal and of the triangle carries nothing.
        """

        def __init__(self, properties):
            super().__init__(properties)
            self.nested = properties["nested"]
            self.m_components = [self.nested.flags(i) for i in range(self.nested.component_count())]
            self.m_flags = self.nested.flags()

        def turn(self, si, active):
            """The interaction in the frame of the interpolated normal, and whether wi is on one side of both."""
            normal = mi.Vector3f(si.shape.eval_attribute_3("vertex_shading_normal", si, active))
            length = dr.norm(normal)
            turned = mi.SurfaceInteraction3f(si)
            turned.sh_frame = mi.Frame3f(dr.select(length > 0, normal / dr.maximum(length, 1e-20), mi.Vector3f(si.n)))
            turned.wi = turned.to_local(si.to_world(si.wi))
            return turned, active & (turned.wi.z * si.wi.z > 0)

        def sample(self, ctx, si, sample1, sample2, active=True):
            turned, active = self.turn(si, active)
            sample, weight = self.nested.sample(ctx, turned, sample1, sample2, active)
            z = sample.wo.z
            sample.wo = si.to_local(turned.to_world(sample.wo))
            active &= z * sample.wo.z > 0
            return sample, dr.select(active, weight, 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            turned, active = self.turn(si, active)
            turned_wo = turned.to_local(si.to_world(wo))
            active &= turned_wo.z * wo.z > 0
            value, pdf = self.nested.eval_pdf(ctx, turned, turned_wo, active)
            return dr.select(active, value, 0), dr.select(active, pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

    class Phong(mi.BSDF):
        """Kd / pi + Ks (n + 2) / (2 pi) cos^n(alpha), alpha between wo and the mirror image of wi: normalised Phong."""

        def __init__(self, properties):
            super().__init__(properties)
            self.diffuse = properties.get_texture("diffuse")
            self.specular = properties.get_texture("specular")
            self.exponent = properties["exponent"]
            self.m_components = [mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.FrontSide,
                                 mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0] | self.m_components[1]

        def lobe_albedos(self, si, active):
            """Kd, Ks, and the probability of sampling the glossy lobe."""
            diffuse, specular = self.diffuse.eval(si, active), self.specular.eval(si, active)
            sum_diffuse, sum_specular = dr.sum(diffuse), dr.sum(specular)
            return diffuse, specular, sum_specular / dr.maximum(sum_diffuse + sum_specular, 1e-20)

        def sample(self, ctx, si, sample1, sample2, active=True):
            _, _, probability = self.lobe_albedos(si, active)
            cos_alpha = dr.power(1 - sample2.x, 1 / (self.exponent + 1))
            sin_alpha = dr.safe_sqrt(1 - dr.square(cos_alpha))
            phi = 2 * dr.pi * sample2.y
            lobe = mi.Vector3f(sin_alpha * dr.cos(phi), sin_alpha * dr.sin(phi), cos_alpha)
            is_glossy = sample1 < probability
            sample = dr.zeros(mi.BSDFSample3f)
            sample.wo = dr.select(is_glossy, mi.Frame3f(mi.reflect(si.wi)).to_world(lobe),
                                  mi.warp.square_to_cosine_hemisphere(sample2))
            value, sample.pdf = self.eval_pdf(ctx, si, sample.wo, active)
            sample.eta = 1
            sample.sampled_type = mi.UInt32(+self.m_flags)
            return sample, value / dr.maximum(sample.pdf, 1e-20)

        def eval_pdf(self, ctx, si, wo, active=True):
            active &= (si.wi.z > 0) & (wo.z > 0)
            diffuse, specular, probability = self.lobe_albedos(si, active)
            cos_alpha = dr.clip(dr.dot(mi.reflect(si.wi), wo), 0, 1)
            lobe = dr.select(cos_alpha > 0, dr.power(cos_alpha, self.exponent), 0) / (2 * dr.pi)
            value = (diffuse / dr.pi + specular * (self.exponent + 2) * lobe) * wo.z
            pdf = (1 - probability) * wo.z / dr.pi + probability * (self.exponent + 1) * lobe
            return dr.select(active, value, 0), dr.select(active, pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active=True):
            return self.eval_pdf(ctx, si, wo, active)[1]

    mi.register_bsdf("interpolated_normals", InterpolatedNormals)
    mi.register_bsdf("phong_lobe", Phong)


def load_image(path):
    """Linear RGB of an image file in 32-bit floats, rows from the top."""
    try:
        bitmap = mi.Bitmap(str(path))
    except RuntimeError:
        raise UserError(f"{path}: Mitsuba cannot read this image") from None
    is_srgb = bitmap.component_format() == mi.Struct.Type.UInt8  # decoded here, since Mitsuba's result is rounded
    if bitmap.srgb_gamma() != is_srgb:
        raise UserError(f"{path}: must be an image of 8 bits a channel, or radiance of 32")
    bitmap.set_srgb_gamma(False)
    pixels = np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32), float)
    return np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4) if is_srgb else pixels


def colour(values):
    """A constant, taken as it is: linear."""
    return {"type": "rgb", "value": [float(value) for value in values]}


def make_diffuse_reflectance(material):
    if material.texture is None:
        return colour(material.diffuse)
    pixels = (material.diffuse * load_image(material.texture)).astype(np.float32)
    return {"type": "bitmap", "data": mi.TensorXf(np.ascontiguousarray(pixels)), "raw": True, "format": "variant",
            "filter_type": "bilinear", "wrap_mode": "repeat"}


def make_bsdf(surface, own_normals):
    material = surface.material
    if material.refractive_index > 0:
        bsdf = {"type": "dielectric", "int_ior": material.refractive_index, "ext_ior": 1.0}
    elif material.specular.any():
        bsdf = {"type": "twosided", "nested": {
            "type": "phong_lobe", "diffuse": make_diffuse_reflectance(material),
            "specular": colour(material.specular), "exponent": material.specular_exponent}}
    else:
        bsdf = {"type": "twosided",
                "nested": {"type": "diffuse", "reflectance": make_diffuse_reflectance(material)}}
    is_left_alone = surface.normals is None or own_normals
    return bsdf if is_left_alone else {"type": "interpolated_normals", "nested": bsdf}


# ---------------------------------------------------------------------------------------------- scenes
def unit_length(scene):
    """How long a unit of our scene is in Mitsuba's. Mitsuba moves the origin of a ray off the surface by 1e-4 times
    one plus its largest coordinate: where coordinates are large, the one does not count."""
    return 1000 / np.linalg.norm(scene.camera["target"] - scene.camera["position"])


def make_mesh(surface, unit, own_normals):
    """A mesh without shared vertices, whose normals are those of its triangles unless Mitsuba's own are wanted."""
    properties = mi.Properties()
    properties["mesh_bsdf"] = mi.load_dict(make_bsdf(surface, own_normals))
    material = surface.material
    if material.emission.any():
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": colour(material.emission)})
    if material.absorption.any():
        strongest = material.absorption.max()
        properties["interior"] = mi.load_dict({
            "type": "homogeneous", "albedo": 0.0, "scale": float(strongest / unit),
            "sigma_t": colour(material.absorption / strongest)})
    count = len(surface.positions)
    has_own_normals = own_normals and surface.normals is not None and not material.emission.any()
    mesh = mi.Mesh(material.name, 3 * count, count, props=properties, has_vertex_normals=has_own_normals,
                   has_vertex_texcoords=True)
    if surface.normals is not None and not own_normals:
        mesh.add_attribute("vertex_shading_normal", 3, surface.normals.astype(np.float32).ravel())
    buffers = mi.traverse(mesh)
    if has_own_normals:
        buffers["vertex_normals"] = surface.normals.astype(np.float32).ravel()
    buffers["vertex_positions"] = (unit * surface.positions).astype(np.float32).ravel()
    buffers["vertex_texcoords"] = surface.texture_coordinates.astype(np.float32).ravel()
    buffers["faces"] = np.arange(3 * count, dtype=np.uint32)
    buffers.update()
    return mesh


def make_light_probe(scene):
    """Mitsuba's rows reach from pole to pole, the first and the last of ours end half a row before: finer ones at
    all of our rows and in the middle between them, and three columns for each of ours, interpolate to the same."""
    pixels = scene.background * load_image(scene.light_probe)
    rows = np.repeat(pixels, 2, axis=0)  # at v = (2 j + 1) / (4 h); wanted are those at v = j / (2 h)
    rows = np.concatenate([pixels[:1], (rows[:-1] + rows[1:]) / 2, pixels[-1:]])
    weights = [1 / 3, 0, 1 / 3]  # of the neighbour for the three columns, of which the middle one is ours
    left, right = np.roll(rows, 1, axis=1), np.roll(rows, -1, axis=1)
    columns = [(1 - weight) * rows + weight * other for weight, other in zip(weights, (left, rows, right))]
    fine = np.stack(columns, axis=2).reshape(len(rows), -1, 3).astype(np.float32)
    # Mitsuba's image has its centre towards +Z, ours towards -Z.
    turn = mi.ScalarTransform4f().rotate([0, 1, 0], 180 + scene.probe_rotation)
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(fine)), "to_world": turn}


def make_camera(scene, width, height, unit):
    position, target, up = unit * scene.camera["position"], unit * scene.camera["target"], scene.camera["up"]
    forward = (target - position) / np.linalg.norm(target - position)
    if np.linalg.norm(np.cross(forward, up)) <= 1e-6 * np.linalg.norm(up):  # leaves the roll open
        up = np.array([0, 0, -1] if abs(forward[1]) > 0.5 else [0, 1, 0])
    return {
        "type": "perspective", "fov": float(scene.camera["vertical_fov"]), "fov_axis": "y",
        "near_clip": 1e-2, "far_clip": 1e8,
        "to_world": mi.ScalarTransform4f().look_at(list(position), list(target), list(up)),
        "sampler": {"type": "independent"},
        "film": {"type": "hdrfilm", "width": width, "height": height, "pixel_format": "rgb",
                 "component_format": "float32", "rfilter": {"type": "box"}},
    }


def make_mitsuba_scene(scene, width, height, max_path_length, own_normals=False):
    """The scene with its integrator, and that integrator's name. With own_normals Mitsuba interpolates normals itself
    where nothing emits, and not at all on lights: nearly the same picture, without Python where it renders."""
    absorbs = any(surface.material.absorption.any() for surface in scene.surfaces)
    integrator = "volpath" if absorbs else "path"
    unit = unit_length(scene)
    content = {"type": "scene", "sensor": make_camera(scene, width, height, unit),
               "integrator": {"type": integrator, "max_depth": max_path_length + 1, "rr_depth": 1 << 30}}
    for i, surface in enumerate(scene.surfaces):
        content[f"surface_{i}"] = make_mesh(surface, unit, own_normals)
    if scene.light_probe:
        content["background"] = make_light_probe(scene)
    elif scene.background.any():
        content["background"] = {"type": "constant", "radiance": colour(scene.background)}
    return mi.load_dict(content), integrator


# ---------------------------------------------------------------------------------------------- rendering
def render_batches(scene, name, batches, samples_per_batch, seed):
    """Mean of the batches, variance of the mean, and the number of batches, less than asked for after Ctrl-C."""
    interrupts = []
    default_handler = signal.signal(signal.SIGINT, lambda *_: interrupts.append("Ctrl-C"))
    total = squares = done = 0
    started = time.monotonic()
    while done < batches and not interrupts:
        # Mitsuba starts a sequence of random numbers of its own for each seed and pixel.
        image = mi.render(scene, spp=samples_per_batch, seed=(seed * batches + done) % (1 << 32))
        image = np.array(image, float)
        total, squares, done = total + image, squares + image * image, done + 1
        show_progress(name, done, batches, started)
    signal.signal(signal.SIGINT, default_handler)
    if done < MIN_BATCHES:
        raise UserError(f"interrupted after {done} of {batches} batches: too early for an image")
    mean = total / done
    return mean, np.maximum(squares / done - mean * mean, 0) / (done - 1), done


def write_reference(path, mean, variance, attributes):
    channels = {}
    for i, name in enumerate("RGB"):
        channels[name], channels[f"variance.{name}"] = mean[:, :, i], variance[:, :, i]
    write_exr(path, channels, attributes)


def is_up_to_date(path, expected):
    """Whether the file holds a reference with these attributes."""
    if not path.exists():
        return False
    attributes = read_attributes(path)
    return all(attributes.get(key) == str(value) for key, value in expected.items())


def make_reference(scene_file, output, width, height, max_path_length, samples, seed, keep=False):
    """Renders a scene unless it is to be kept and there already; None stands for what the scene asks for."""
    scene = read_scene(scene_file)
    width, height = width or scene.width, height or scene.height
    max_path_length = scene.max_path_length if max_path_length is None else max_path_length
    batches = max(BATCHES, math.ceil(samples * width * height / MAX_BATCH_PATHS))
    samples_per_batch = math.ceil(samples / batches)
    attributes = {"scene": Path(scene_file).name, "scene_hash": scene.hash, "width": width, "height": height,
                  "max_path_length": max_path_length, "seed": seed, "samples": batches * samples_per_batch}
    if keep and is_up_to_date(output, attributes):
        print(f"{output}: is up to date")
        return
    mitsuba_scene, integrator = make_mitsuba_scene(scene, width, height, max_path_length)
    mean, variance, done = render_batches(mitsuba_scene, output.stem, batches, samples_per_batch, seed)
    if not np.isfinite(mean).all():
        raise UserError(f"{scene_file}: Mitsuba's image has pixels that are infinite or not a number")
    attributes |= {"samples": done * samples_per_batch, "batches": done, "renderer": "Mitsuba",
                   "version": mi.__version__, "variant": mi.variant(), "integrator": integrator}
    write_reference(output, mean, variance, attributes)
    error = math.sqrt(variance.mean(axis=2).sum()) / mean.mean() / (width * height) if mean.any() else 0
    print(f"{output}: {done * samples_per_batch} samples a pixel, the image's mean is known to {100 * error:.2g} %")
    if done < batches:
        raise KeyboardInterrupt


def positive(text):
    value = int(text)
    if value < 1:
        raise ValueError
    return value


def not_negative(text):
    return positive(str(int(text) + 1)) - 1


def choose_variant(variant):
    mi.set_variant(variant)
    if variant == "llvm_ad_rgb" and dr.detail.llvm_version()[0] < 19:  # it would abort
        raise UserError("LLVM is older than 19: install libllvm19 and let DRJIT_LIBLLVM_PATH name its library")
    mi.set_log_level(mi.LogLevel.Error)
    define_bsdfs()


def run_mitsuba(variant, work):
    """Calls work() with Mitsuba's variant chosen; errors end the program in one line."""
    try:
        choose_variant(variant)
        work()
    except UserError as error:
        sys.exit(f"error: {error}")
    except (RuntimeError, ImportError) as error:
        while error.__cause__:  # the first one says what is wrong
            error = error.__cause__
        sys.exit(f"error: Mitsuba with variant {variant}: {' '.join(str(error).split())[:300]}")
    except KeyboardInterrupt:
        sys.exit("interrupted")


def main():
    parser = Parser(prog="./lab reference", description="Renders reference images with Mitsuba 3.")
    parser.add_argument("scene", nargs="?", type=Path, help="a .json or .obj file")
    parser.add_argument("--all", action="store_true", 
                        help="all that the tests use, into assets/references; only --seed and --variant count")
    parser.add_argument("--output", type=Path, metavar="FILE.exr", help="default: output/references/SCENE.exr")
    parser.add_argument("--width", type=positive, help="default: as the scene says, else 512")
    parser.add_argument("--height", type=positive, help="default: as the scene says, else 512")
    parser.add_argument("--max-path-length", type=not_negative, help="default: as the scene says, else 8")
    parser.add_argument("--samples", type=positive, default=1024,
                        help="a pixel, rounded up to a multiple of 64 or more batches; default: 1024")
    parser.add_argument("--seed", type=not_negative, default=1, help="default: 1")
    parser.add_argument("--variant", choices=["scalar_rgb", "llvm_ad_rgb", "cuda_ad_rgb"], default="scalar_rgb",
                        help="of Mitsuba; default: scalar_rgb")
    options = parser.parse_args()
    if options.all == (options.scene is not None):
        parser.error("either a scene or --all is needed")
    if options.output and options.output.suffix != ".exr":
        parser.error(f"--output {options.output}: must end in .exr")

    def make():
        if options.all:
            for name, max_path_length, samples in SHIPPED:
                make_reference(ROOT / f"assets/scenes/{name}.json",
                               ROOT / f"assets/references/{name}_{max_path_length}.exr", SHIPPED_SIZE, SHIPPED_SIZE,
                               max_path_length, samples, options.seed, keep=True)
        else:
            output = options.output or ROOT / f"output/references/{options.scene.stem}.exr"
            make_reference(options.scene, output, options.width, options.height, options.max_path_length,
                           options.samples, options.seed)

    run_mitsuba(options.variant, make)


if __name__ == "__main__":
    main()
