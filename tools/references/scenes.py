"""Reads our scene files (.json, .obj, .mtl) in Python, for tools that hand them to other renderers.

Shares no code with common/scene: if the two read a file differently, a comparison with a reference shows it. Does not check
files for mistakes, as the chapters do, but refuses what it does not read. Arrays are in double precision.
"""
import itertools
import json
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from material_keywords import KEYWORDS
from project import UserError
from references.bodies import Bodies, Body, connected_parts
from references.lamps import resolve_lamps
from references.meshes import Material, ObjFile, materials_in_order, triangle_normals


class SourceFiles:
    """Reads files and hashes their contents in reading order (FNV-1a, 64 bits), like common/scene/text_lines.h."""

    def __init__(self):
        self.hash = 0xCBF29CE484222325

    def read(self, path):
        try:
            content = path.read_bytes()
        except OSError as error:
            raise UserError(f"{path}: cannot be read: {error.strerror}") from None
        value = self.hash
        for byte in content:
            value = (value ^ byte) * 0x100000001B3 & 0xFFFFFFFFFFFFFFFF
        self.hash = value
        return content

    def read_text(self, path):
        return self.read(path).decode(errors="surrogateescape")


@dataclass
class Surface:
    """All triangles of one material between two media in world space: arrays [triangle, corner], counter-clockwise seen from the
    front. A medium has extinction, albedo, anisotropy, and with a grid density (its file) and box; that of glass has absorption.
    """

    material: Material
    positions: np.ndarray
    normals: np.ndarray | None  # to be interpolated, then normalised; None to use the triangles' own
    texture_coordinates: np.ndarray  # v down from the top row of the image
    inside: dict | None  # the medium behind the fronts
    outside: dict | None
    is_open: bool  # no surface, but a boundary of media


@dataclass
class Scene:
    surfaces: list
    camera: dict  # position, target, up, vertical_fov in degrees, aperture_diameter, focus_distance (0: that of the target)
    fog: dict | None  # a medium
    camera_medium: dict | None  # around the camera
    background: np.ndarray  # radiance, or factor of the light probe
    light_probe: Path | None
    probe_rotation: float  # degrees
    width: int
    height: int
    max_path_length: int
    hash: str  # over all files, as the chapters write it to their reports


def limit_reflectance(material, specular):
    """Ks counts only on request; albedos are divided by the largest channel of their sum if that exceeds 1."""
    if not specular:
        material.specular_albedo = np.zeros(3)
    members = [keyword.member for keyword in KEYWORDS if keyword.is_albedo]
    largest = max(1, *sum(getattr(material, member) for member in members))
    for member in members:
        setattr(material, member, getattr(material, member) / largest)


OPEN = Material("open boundary")  # whose own materials do not matter


def find_bodies(path, fog, meshes, placements, positions, absorptions):
    """The bodies of a scene with media, from the triangles of all meshes."""
    bodies, first = [], 0
    for index, _, medium in placements:
        mesh, is_open = meshes[index], bool(medium and medium["is_open"])
        bounding = np.array([is_open or m.refractive_index > 0 for m in mesh.materials]).nonzero()[0]
        parts = connected_parts(mesh.positions[bounding]) if len(bounding) else []
        for triangles, is_closed in ((bounding[part], is_closed) for part, is_closed in parts):
            content = medium or absorptions[id(mesh.materials[triangles[0]])]
            if not medium and len({tuple(mesh.materials[i].absorption) for i in triangles}) > 1:
                raise UserError(
                    f"{path}: references with media know one Tf in a piece of glass, {mesh.path} has several: use one"
                )
            bodies.append(Body(first + triangles, content, is_open, is_closed, positions[first + triangles]))
        first += len(mesh.materials)
    return Bodies(path, fog, positions, bodies)


def place_meshes(path, meshes, placements, fog):
    """Surfaces in world space, one per material and media beside it, and the bodies if there are media; placements: (index of the
    mesh, object-to-world matrix, medium)."""
    parts = []
    for index, matrix, _ in placements:
        mesh, linear = meshes[index], matrix[:3, :3]
        # The front is determined in object space: a mirrored instance keeps it.
        order = [0, 2, 1] if np.linalg.det(linear) < 0 else [0, 1, 2]
        arrays = (mesh.positions @ linear.T + matrix[:3, 3], mesh.normals @ np.linalg.inv(linear), mesh.texture_coordinates)
        parts.append([array[:, order] for array in arrays])
    all_positions, all_normals, all_coordinates = (np.concatenate(arrays) for arrays in zip(*parts))
    all_materials = [
        OPEN if medium and medium["is_open"] else material
        for index, _, medium in placements
        for material in meshes[index].materials
    ]
    owners = np.repeat(range(len(parts)), [len(positions) for positions, _, _ in parts])
    all_positions, is_kept = resolve_lamps(path, all_positions, all_materials, owners)

    absorptions = {id(m): {"absorption": m.absorption} if m.absorption.any() else None for m in all_materials}
    sides = [(absorptions[id(material)], None) for material in all_materials]  # without media, glass lies in none
    bodies = None
    if fog or any(medium for *_, medium in placements):
        bodies = find_bodies(path, fog, meshes, placements, all_positions, absorptions)
        sides = bodies.sides(len(all_materials))
    groups = {}  # triangles by their material and the media beside them
    for triangle, (material, (inside, outside)) in enumerate(zip(all_materials, sides)):
        groups.setdefault((id(material), id(inside), id(outside)), (material, inside, outside, []))[3].append(triangle)
    surfaces = []
    for material, inside, outside, triangles in groups.values():
        chosen = np.array(triangles)[is_kept[triangles]]
        if not len(chosen):
            continue
        positions, normals, texture_coordinates = (array[chosen] for array in (all_positions, all_normals, all_coordinates))
        flat = np.broadcast_to(triangle_normals(positions)[:, None], normals.shape)
        normals = np.where(np.isnan(normals), flat, normals)
        length = np.linalg.norm(normals, axis=2, keepdims=True)
        is_flat = np.abs(normals / length - flat).max() < 1e-5
        normals = None if is_flat else normals
        surfaces.append(Surface(material, positions, normals, texture_coordinates, inside, outside, material is OPEN))
    return surfaces, bodies


# ---------------------------------------------------------------------------------------------- scenes
def only(path, entry, *keys):
    """The entry. A key that is not read here may change the picture."""
    for key in entry:
        if key not in keys:
            raise UserError(f'{path}: references have no key "{key}": leave it out')
    return entry


def triple(value):
    return np.broadcast_to(np.asarray(value, float), 3)


def placement_matrix(path, entry):
    """Scale, then rotation, then translation."""
    only(path, entry, "file", "materials", "medium", "scale", "rotation", "translation")
    matrix = np.eye(4)
    matrix[:3, :3] = np.diag(triple(entry.get("scale", 1)))
    if "rotation" in entry:
        turn = only(path, entry["rotation"], "axis", "degrees")
        x, y, z = np.array(turn["axis"], float) / np.linalg.norm(turn["axis"])
        angle = math.radians(turn["degrees"])
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])  # Rodrigues' formula
        rotation = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
        matrix[:3, :3] = rotation @ matrix[:3, :3]
    matrix[:3, 3] = entry.get("translation", 0)
    return matrix


def read_medium(path, entry, *others):
    medium = {"anisotropy": 0, **only(path, entry, "extinction", "albedo", "anisotropy", "density", "box", *others)}
    medium["is_open"] = medium.pop("boundary", "") == "open"
    return medium | ({"density": path.parent / medium["density"]} if "density" in medium else {})


def framing_camera(meshes, placements):
    """The camera for scenes without one: the bounding sphere touches the top and bottom of the image."""
    points = []
    for index, matrix, _ in placements:
        corners = meshes[index].positions.reshape(-1, 3)
        low, high = corners.min(axis=0), corners.max(axis=0)
        box = np.array(list(itertools.product(*zip(low, high))))
        points.append(box @ matrix[:3, :3].T + matrix[:3, 3])
    low, high = np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
    centre, radius, fov = (low + high) / 2, np.linalg.norm(high - low) / 2, 45
    direction = np.array([0, 0.25, 1]) / math.hypot(0.25, 1)
    return {
        "position": list(centre + radius / math.sin(math.radians(fov / 2)) * direction),
        "target": list(centre),
        "up": [0, 1, 0],
        "vertical_fov": fov,
    }


def read_description(path, files):
    """The content of a .json scene; for a bare .obj, the mesh alone."""
    return {"meshes": [{"file": path.name}]} if path.suffix.lower() == ".obj" else json.loads(files.read_text(path))


def mesh_files(path, entry):
    """The OBJ file of an entry of a scene's "meshes", and the MTL file that stands for its own, or None."""
    return tuple(name and path.parent / name for name in (entry["file"], entry.get("materials")))


def read_scene(path):
    """Reads a scene with all its files, in the same order as the renderer, since the hash depends on it."""
    path = Path(path)
    files = SourceFiles()
    try:
        root = only(
            path,
            read_description(path, files),
            "description",
            "meshes",
            "camera",
            "background",
            "fog",
            "specular",
            "multiple_scattering",
            "width",
            "height",
            "samples",
            "max_path_length",
        )
        meshes, indices, placements = [], {}, []
        for entry in root["meshes"]:
            file, materials = mesh_files(path, entry)
            key = file.resolve(), materials and materials.resolve()
            if key not in indices:
                indices[key] = len(meshes)
                meshes.append(ObjFile(file, files, materials))
            medium = entry.get("medium") and read_medium(path, entry["medium"], "boundary")
            placements.append((indices[key], placement_matrix(path, entry), medium))

        textures = set()
        for mesh in meshes:
            for material in materials_in_order(mesh):
                limit_reflectance(material, root.get("specular", False))
                if material.texture and material.texture.resolve() not in textures:
                    textures.add(material.texture.resolve())
                    files.read(material.texture)
        fog = root.get("fog") and read_medium(path, root["fog"])
        for medium in (fog, *(medium for *_, medium in placements)):
            if medium and "density" in medium:
                files.read(medium["density"])
        surfaces, bodies = place_meshes(path, meshes, placements, fog)
        if root.get("multiple_scattering") and any(surface.material.roughness > 0 for surface in surfaces):
            raise UserError(f'{path}: Mitsuba has no "multiple_scattering" on microfacets: leave it out')

        background = only(path, root.get("background", {}), "radiance", "light_probe", "intensity", "rotation_degrees")
        light_probe = path.parent / background["light_probe"] if "light_probe" in background else None
        if light_probe:
            files.read(light_probe)
        radiance = background.get("intensity", 1) if light_probe else background.get("radiance", 0)
        if path.suffix.lower() == ".obj" and not any(s.material.emission.any() for s in surfaces):
            radiance = 1  # a bare mesh without lights is lit by a white sky
        camera = {
            "up": [0, 1, 0],
            "vertical_fov": 45,
            "aperture_diameter": 0,
            "focus_distance": 0,
            **(root.get("camera") or framing_camera(meshes, placements)),
        }
        camera = {
            key: np.asarray(value, float)
            for key, value in only(
                path, camera, "position", "target", "up", "vertical_fov", "aperture_diameter", "focus_distance"
            ).items()
        }
        camera_medium = bodies and bodies.medium_at(camera["position"])
        return Scene(
            surfaces,
            camera,
            fog,
            camera_medium,
            triple(radiance),
            light_probe,
            float(background.get("rotation_degrees", 0)),
            root.get("width", 512),
            root.get("height", 512),
            root.get("max_path_length", 8),
            f"{files.hash:x}",
        )
    except (LookupError, TypeError, ValueError, np.linalg.LinAlgError) as error:
        raise UserError(f"{path}: cannot be read: {error!r}; a chapter says where the mistake is: ./lab run 1 {path}") from None
