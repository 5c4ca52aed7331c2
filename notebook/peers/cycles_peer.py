"""Scenes in Cycles, Blender's path tracer, as the module bpy has it."""
import os
import tempfile
from pathlib import Path

import bpy
import numpy as np
from peers.renderers import Frame, timed
from peers.simple_scenes import camera_matrix, corners, refuse_what_peers_lack

UNLIMITED = 1024  # bounces of a kind: only max_bounces counts


def new_node(tree, kind, **inputs):
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    return node


def colour(values):
    return (*map(float, values), 1.0)


def front_emission(tree, radiance):
    """Emission to the front alone: its strength is 1 - Backfacing."""
    emission = new_node(tree, "Emission", Color=colour(radiance))
    front = new_node(tree, "Math")
    front.operation, front.inputs[0].default_value = "SUBTRACT", 1.0
    tree.links.new(front.inputs[1], new_node(tree, "NewGeometry").outputs["Backfacing"])
    tree.links.new(emission.inputs["Strength"], front.outputs[0])
    return emission


def added(tree, *shaders):
    both = new_node(tree, "AddShader")
    for place, shader in enumerate(shaders):
        tree.links.new(both.inputs[place], shader.outputs[0])
    return both


def make_material(material):
    made = bpy.data.materials.new(material.name)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    if material.refractive_index > 0:
        shader = new_node(tree, "BsdfGlass", Color=colour(np.ones(3)), Roughness=0.0, IOR=material.refractive_index)
    else:
        shader = new_node(tree, "BsdfDiffuse", Color=colour(material.diffuse_albedo), Roughness=0.0)
    if material.emission.any():
        shader = added(tree, shader, front_emission(tree, material.emission))
        made.cycles.emission_sampling = "FRONT"
    tree.links.new(new_node(tree, "OutputMaterial").inputs["Surface"], shader.outputs[0])
    return made


def add_mesh(surface):
    """A mesh without shared vertices, in our coordinates."""
    positions, triangles, normals = corners(surface)
    mesh = bpy.data.meshes.new(surface.material.name)
    mesh.from_pydata(positions, [], triangles)
    mesh.materials.append(make_material(surface.material))
    if normals is None:
        mesh.shade_flat()
    else:
        mesh.shade_smooth()
        mesh.normals_split_custom_set(normals)
    bpy.context.collection.objects.link(bpy.data.objects.new(surface.material.name, mesh))


def add_camera(camera):
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle = "VERTICAL", np.radians(float(camera["vertical_fov"]))
    data.clip_start, data.clip_end = 1e-3, 1e6
    placed = bpy.data.objects.new("camera", data)
    placed.matrix_world = camera_matrix(camera).T.tolist()
    bpy.context.collection.objects.link(placed)
    bpy.context.scene.camera = placed


def add_fog(fog):
    """The world's volume: scattering by the albedo, and absorption by what it lacks to 1."""
    world = bpy.context.scene.world = bpy.data.worlds.new("fog")
    world.use_nodes = True
    tree = world.node_tree
    tree.nodes.clear()
    albedo, density = np.broadcast_to(fog["albedo"], 3), float(fog["extinction"])
    parts = (
        new_node(tree, "VolumeScatter", Color=colour(albedo), Density=density, Anisotropy=float(fog["anisotropy"])),
        new_node(tree, "VolumeAbsorption", Color=colour(albedo), Density=density),
    )
    tree.links.new(new_node(tree, "OutputWorld").inputs["Volume"], added(tree, *parts).outputs[0])


def choose_settings(scene, options):
    """No clamping, adaptive sampling, denoising nor blurred caustics; a box filter of a pixel; paths of our length."""
    render, cycles = scene.render, scene.cycles
    render.engine, render.resolution_x, render.resolution_y, render.resolution_percentage = (
        "CYCLES",
        options.width,
        options.height,
        100,
    )
    render.use_persistent_data, render.threads_mode, render.threads = True, "FIXED", len(os.sched_getaffinity(0))
    render.use_compositing = render.use_sequencer = False
    render.image_settings.file_format, render.image_settings.color_mode = "OPEN_EXR", "RGB"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "ZIP"
    bounces = options.max_path_length - 1  # Cycles does not count direct light
    for name, value in {
        "device": "CPU",
        "use_adaptive_sampling": False,
        "use_denoising": False,
        "sample_clamp_direct": 0.0,
        "sample_clamp_indirect": 0.0,
        "pixel_filter_type": "BOX",
        "filter_width": 1.0,
        "blur_glossy": 0.0,
        "caustics_reflective": True,
        "caustics_refractive": True,
        "max_bounces": bounces,
        "min_light_bounces": 0,
        "sampling_pattern": "TABULATED_SOBOL",
        "use_auto_tile": False,
        "use_light_tree": options.sampler == "light_tree",
        **{f"{kind}_bounces": UNLIMITED for kind in ("diffuse", "glossy", "transmission", "volume")},
    }.items():
        setattr(cycles, name, value)


def rendered_picture():
    """Array [row, column, channel]. Blender lets go of the pixels of a render only through a file."""
    with tempfile.TemporaryDirectory() as folder:
        file = str(Path(folder) / "picture.exr")
        bpy.data.images["Render Result"].save_render(file)
        image = bpy.data.images.load(file)
        image.colorspace_settings.name = "Non-Color"
        pixels = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(pixels)
        width, height = image.size
        bpy.data.images.remove(image)
    return pixels.reshape(height, width, -1)[::-1, :, :3].astype(float)  # Blender's first row is the lowest


class Renderer:
    note, largest = "", 1 << 16

    def __init__(self, scene, options):
        refuse_what_peers_lack(scene, "Cycles")
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.scene, self.name, self.integrator = bpy.context.scene, f"Cycles {bpy.app.version_string}", "path"
        for surface in scene.surfaces:
            add_mesh(surface)
        add_camera(scene.camera)
        if scene.fog:
            add_fog(scene.fog)
        choose_settings(self.scene, options)
        self.discarded_seconds = self.render(1, 0).seconds  # hands the scene over to Cycles, which keeps it

    def render(self, samples, seed):
        self.scene.cycles.samples, self.scene.cycles.seed = samples, seed % (1 << 31)
        with timed() as clock:
            bpy.ops.render.render()
        return Frame(rendered_picture(), samples, clock.seconds, clock.cpu_seconds)
