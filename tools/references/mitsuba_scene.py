"""Our scenes in Mitsuba 3. Import this module before the others here: it reports what to install."""
from project import UserError

try:
    import drjit as dr
    import mitsuba as mi
    import numpy as np
except ImportError as error:
    raise UserError(
        f"{error}: this needs Mitsuba 3: `pip install mitsuba`, in a virtual environment that is active here"
    ) from None

MAX_BATCH_PATHS = 1 << 24  # so that a batch fits into memory and ends in reasonable time


def load_image(path):
    """Linear RGB of an image file in 32-bit floats, rows from the top."""
    try:
        bitmap = mi.Bitmap(str(path))
    except RuntimeError:
        raise UserError(f"{path}: Mitsuba cannot read this image") from None
    is_srgb = bitmap.component_format() == mi.Struct.Type.UInt8  # decoded here, since Mitsuba rounds its result
    if bitmap.srgb_gamma() != is_srgb:
        raise UserError(f"{path}: must be an image of 8 bits a channel, or radiance of 32")
    bitmap.set_srgb_gamma(False)
    pixels = np.array(bitmap.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32), float)
    return np.where(pixels <= 0.04045, pixels / 12.92, ((pixels + 0.055) / 1.055) ** 2.4) if is_srgb else pixels


def colour(values):
    """A constant linear colour."""
    return {"type": "rgb", "value": [float(value) for value in values]}


# ---------------------------------------------------------------------------------------------- scenes
def unit_length(scene):
    """The length of our unit in Mitsuba's scene. Mitsuba moves a ray's origin off the surface by 1e-4 (1 + its largest
    coordinate). Coordinates are scaled up so that the 1 is negligible."""
    return 1000 / np.linalg.norm(scene.camera["target"] - scene.camera["position"])


def make_mesh(surface, unit, own_normals, media):
    """A mesh without shared vertices. It has vertex normals only if own_normals asks for Mitsuba's interpolation."""
    from references import bsdfs  # which needs the variant

    properties = mi.Properties()
    properties["mesh_bsdf"] = mi.load_dict(bsdfs.make_bsdf(surface, own_normals))
    material = surface.material
    if material.emission.any():
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": colour(material.emission)})
    for side, medium in (("interior", surface.inside), ("exterior", surface.outside)):
        if medium:
            properties[side] = media(medium)
    count = len(surface.positions)
    has_own_normals = own_normals and surface.normals is not None and not material.emission.any()
    mesh = mi.Mesh(
        material.name, 3 * count, count, props=properties, has_vertex_normals=has_own_normals, has_vertex_texcoords=True
    )
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
    """Mitsuba's rows extend from pole to pole; our first and last row end half a row earlier. A finer image, with rows at ours
    and halfway between them and three columns for each of ours, interpolates to the same."""
    pixels = scene.background * load_image(scene.light_probe)
    rows = np.repeat(pixels, 2, axis=0)  # at v = (2 j + 1) / (4 h); we need rows at v = j / (2 h)
    rows = np.concatenate([pixels[:1], (rows[:-1] + rows[1:]) / 2, pixels[-1:]])
    weights = [1 / 3, 0, 1 / 3]  # of the neighbour for the three columns, the middle one being ours
    left, right = np.roll(rows, 1, axis=1), np.roll(rows, -1, axis=1)
    columns = [(1 - weight) * rows + weight * other for weight, other in zip(weights, (left, rows, right))]
    fine = np.stack(columns, axis=2).reshape(len(rows), -1, 3).astype(np.float32)
    # Mitsuba's image has its centre towards +Z, ours towards -Z.
    turn = mi.ScalarTransform4f().rotate([0, 1, 0], 180 + scene.probe_rotation)
    return {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(fine)), "to_world": turn}


def make_medium(medium, unit):
    if "absorption" in medium:
        strongest = medium["absorption"].max()
        return {
            "type": "homogeneous",
            "albedo": 0.0,
            "scale": float(strongest / unit),
            "sigma_t": colour(medium["absorption"] / strongest),
        }
    content = {"albedo": colour(np.broadcast_to(medium["albedo"], 3)), "phase": {"type": "hg", "g": medium["anisotropy"]}}
    if "density" not in medium:
        return {"type": "homogeneous", "sigma_t": medium["extinction"] / unit, **content}
    return {
        "type": "heterogeneous",
        "scale": medium["extinction"] / unit,
        **content,
        "sigma_t": {"type": "gridvolume", "filename": str(medium["density"]), "to_world": make_box(medium, unit)},
    }


def make_box(medium, unit):
    """The transform of the unit cube to the box of a grid."""
    low, high = unit * np.array(medium["box"], float)
    return mi.ScalarTransform4f().translate(list(low)).scale(list(high - low))


def make_fog_box(fog, unit, media):
    """A grid ends at its box. Other fog has no end: a ray that starts in a medium stays there until it crosses a boundary."""
    from_minus_one = mi.ScalarTransform4f().translate([0.5, 0.5, 0.5]).scale([0.5, 0.5, 0.5])
    return {"type": "cube", "to_world": make_box(fog, unit) @ from_minus_one, "bsdf": {"type": "null"}, "interior": media(fog)}


def make_camera(scene, width, height, unit, sampler):
    position, target, up = unit * scene.camera["position"], unit * scene.camera["target"], scene.camera["up"]
    forward = (target - position) / np.linalg.norm(target - position)
    if np.linalg.norm(np.cross(forward, up)) <= 1e-6 * np.linalg.norm(up):  # leaves the roll undefined
        up = np.array([0, 0, -1] if abs(forward[1]) > 0.5 else [0, 1, 0])
    lens = {"type": "perspective"}
    if diameter := float(scene.camera["aperture_diameter"]):
        focus = float(scene.camera["focus_distance"]) or np.linalg.norm(target - position) / unit
        lens = {"type": "thinlens", "aperture_radius": unit * diameter / 2, "focus_distance": unit * focus}
    return {
        **lens,
        "fov": float(scene.camera["vertical_fov"]),
        "fov_axis": "y",
        "near_clip": 1e-2,
        "far_clip": 1e8,
        "to_world": mi.ScalarTransform4f().look_at(list(position), list(target), list(up)),
        "sampler": {"type": sampler},
        "film": {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
    }


def make_mitsuba_scene(scene, width, height, max_path_length, own_normals=False, sampler="independent"):
    """The scene with its integrator, and that integrator's name. With own_normals Mitsuba interpolates normals itself where
    nothing emits, and not at all on lights: nearly the same picture, without Python during the render."""
    has_media = scene.fog or any(surface.inside or surface.outside for surface in scene.surfaces)
    integrator = "volpath" if has_media else "path"
    unit = unit_length(scene)
    content = {
        "type": "scene",
        "sensor": make_camera(scene, width, height, unit, sampler),
        "integrator": {"type": integrator, "max_depth": max_path_length + 1, "rr_depth": 1 << 30},
    }
    made = {}

    def media(medium):
        """Mitsuba's, the same one for all its boundaries."""
        if id(medium) not in made:
            made[id(medium)] = mi.load_dict(make_medium(medium, unit))
        return made[id(medium)]

    if scene.camera_medium:
        content["sensor"]["medium"] = media(scene.camera_medium)
    if scene.fog and "density" in scene.fog:
        content["fog"] = make_fog_box(scene.fog, unit, media)
    for i, surface in enumerate(scene.surfaces):
        content[f"surface_{i}"] = make_mesh(surface, unit, own_normals, media)
    # Fog without end hides what is infinitely far away. Mitsuba would show it at the distance of a sphere around the scene.
    hides_sky = scene.fog and "density" not in scene.fog
    if scene.light_probe and not hides_sky:
        content["background"] = make_light_probe(scene)
    elif scene.background.any() and not hides_sky:
        content["background"] = {"type": "constant", "radiance": colour(scene.background)}
    return mi.load_dict(content), integrator


def run_mitsuba(variant, work):
    """Calls work() with Mitsuba's variant selected; errors end the program with one line."""
    try:
        mi.set_variant(variant)
        if variant == "llvm_ad_rgb" and dr.detail.llvm_version()[0] < 19:  # Mitsuba would abort
            raise UserError("LLVM is older than 19: install libllvm19 and let DRJIT_LIBLLVM_PATH name its library")
        mi.set_log_level(mi.LogLevel.Error)
        work()
    except (RuntimeError, ImportError) as error:
        while error.__cause__:  # the innermost one says what is wrong
            error = error.__cause__
        raise UserError(f"Mitsuba with variant {variant}: {' '.join(str(error).split())[:300]}") from None
