"""Reads our scene files (.json, .obj, .mtl) in Python, for tools that hand them to other renderers.

It follows the section "Scene files" of the documentation as common/scene does, from which it shares no code:
where the two read a file differently, a comparison with a reference shows it. Arrays are in double precision.
"""
import json
import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


class UserError(Exception):
    """Bad input: one line that says what is wrong, where, and what to do."""


class SourceFiles:
    """Reads files and hashes their contents in reading order (FNV-1a, 64 bits), as common/scene/source_files.h."""

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


@dataclass(eq=False)  # compared and hashed by identity: two files may use the same name
class Material:
    """Reflectances are linear and at most 1 in sum; absorption is -ln Tf per unit of world length."""
    name: str
    diffuse: np.ndarray = field(default_factory=lambda: np.zeros(3))
    emission: np.ndarray = field(default_factory=lambda: np.zeros(3))
    specular: np.ndarray = field(default_factory=lambda: np.zeros(3))
    specular_exponent: float = 1.0
    refractive_index: float = 0.0  # 0 for an opaque surface
    absorption: np.ndarray = field(default_factory=lambda: np.zeros(3))
    texture: Path | None = None


@dataclass
class Surface:
    """All triangles of one material in world space: arrays [triangle, corner], counter-clockwise from the front."""
    material: Material
    positions: np.ndarray
    normals: np.ndarray | None  # to be interpolated, then normalised; None where they are those of the triangles
    texture_coordinates: np.ndarray  # v down from the top row of the image


@dataclass
class Scene:
    surfaces: list
    camera: dict  # position, target, up, vertical_fov in degrees
    background: np.ndarray  # radiance, or factor of the light probe
    light_probe: Path | None
    probe_rotation: float  # degrees
    width: int
    height: int
    max_path_length: int
    hash: str  # of all files, as the chapters write it into their reports


# ---------------------------------------------------------------------------------------------- meshes
NUMBERS = {"Kd": 3, "Ke": 3, "Ks": 3, "Tf": 3, "Kt": 3, "Ns": 1, "Ni": 1, "d": 1, "Tr": 1}


def to_floats(words, count, where):
    """The first numbers of a line, rounded to 32 bits as the renderer holds them."""
    try:
        values = np.array([float(word) for word in words[:count]], np.float32).astype(float)
    except ValueError:
        values = np.array([math.nan])
    if len(values) < count or not np.isfinite(values).all():
        raise UserError(f"{where}: expected {count} finite numbers, found '{' '.join(words[:count])}'")
    return values


def name_after_keyword(line, where):
    """The rest of a line: names may contain spaces."""
    words = line.split("#")[0].split(None, 1)
    if len(words) < 2:
        raise UserError(f"{where}: {words[0]} needs a name")
    return words[1].rstrip()


def read_mtl(path, texture_folder, files):
    """The materials of an MTL file by name; of two with the same name the first counts."""
    statements = []  # one dictionary a material
    for number, line in enumerate(files.read_text(path).splitlines(), 1):
        words = line.split("#")[0].split()
        if not words:
            continue
        keyword, where = words[0], f"{path}:{number}"
        if keyword == "newmtl":
            statements.append({"newmtl": name_after_keyword(line, where)})
        elif not statements:
            raise UserError(f"{where}: not a material file: it must start with newmtl")
        elif keyword in NUMBERS:
            statements[-1]["Tf" if keyword == "Kt" else keyword] = to_floats(words[1:], NUMBERS[keyword], where)
        elif keyword == "map_Kd":
            name = name_after_keyword(line, where)
            statements[-1]["map_Kd"] = words[-1] if name.startswith("-") else name  # options have no effect

    materials = {}
    for stated in statements:
        material = Material(stated["newmtl"])
        material.emission = stated.get("Ke", material.emission)
        material.specular = stated.get("Ks", material.specular)
        material.specular_exponent = float(stated.get("Ns", [1])[0])
        material.diffuse = stated.get("Kd", np.ones(3) if "map_Kd" in stated else material.diffuse)
        if "map_Kd" in stated:
            material.texture = texture_folder / stated["map_Kd"].replace("\\", "/")
        opacity = stated["d"][0] if "d" in stated else 1 - stated.get("Tr", [0])[0]
        if opacity < 1:
            material.refractive_index = float(stated.get("Ni", [1])[0])
            transmittance = stated.get("Tf", np.ones(3))
            if material.refractive_index <= 0 or min(transmittance) <= 0:
                raise UserError(f"{path}: material '{material.name}' is transparent: Ni and Tf must be above 0")
            material.absorption = np.maximum(0, -np.log(transmittance))
        materials.setdefault(material.name, material)
    return materials


def triangulate(polygon):
    """Triples of corner indices. Cuts off ears, from the second corner on: a fan where the polygon is convex."""
    rest = list(range(len(polygon)))
    if len(rest) == 3:
        return [tuple(rest)]
    offsets = polygon - polygon[0]
    normal = sum(np.cross(a, b) for a, b in zip(offsets[1:], offsets[2:]))
    # Along the axis closest to the normal, so that the projection is counter-clockwise.
    axis = np.argmax(np.abs(normal))
    points = offsets[:, [(axis + 1) % 3, (axis + 2) % 3]] * [1, -1 if normal[axis] < 0 else 1]

    def area(a, b, c):
        (x, y), (z, w) = points[b] - points[a], points[c] - points[a]
        return x * w - y * z

    def is_ear(i):
        a, b, c = rest[i - 1], rest[i], rest[(i + 1) % len(rest)]
        others = (p for p in rest if not any(np.array_equal(points[p], points[q]) for q in (a, b, c)))
        return area(a, b, c) > 0 and not any(
            area(a, b, p) >= 0 and area(b, c, p) >= 0 and area(c, a, p) >= 0 for p in others)

    triangles = []
    while len(rest) > 3:
        ear = next((i for i in [*range(1, len(rest)), 0] if is_ear(i)), 1)
        triangles.append((rest[ear - 1], rest[ear], rest[(ear + 1) % len(rest)]))
        del rest[ear]
    return triangles + [tuple(rest)]


class ObjFile:
    """The triangles of an OBJ file in object space: arrays [triangle, corner], normals NaN where there are none.

    Triangles without area are dropped, and corners ordered counter-clockwise seen from the front."""

    def __init__(self, path, files):
        self.path, self.files = path, files
        self.materials = []  # of the triangles
        self._available = {}
        positions, texture_coordinates, normals, corners = [], [], [], []
        material = grey = None
        for number, line in enumerate(files.read_text(path).splitlines(), 1):
            words = line.split("#")[0].split()
            keyword, where = words[0] if words else "", f"{path}:{number}"
            if keyword == "v":
                positions.append(to_floats(words[1:], 3, where))
            elif keyword == "vn":
                normals.append(to_floats(words[1:], 3, where))
            elif keyword == "vt":
                texture_coordinates.append(to_floats([*words[1:], "0"], 2, where))
            elif keyword == "mtllib":
                self._read_materials(name_after_keyword(line, where), where)
            elif keyword == "usemtl":
                name = name_after_keyword(line, where)
                if self._available and name not in self._available:
                    raise UserError(f"{where}: there is no material '{name}' in the material files named so far")
                material = self._available.get(name)
            elif keyword == "f":
                counts = (len(positions), len(texture_coordinates), len(normals))
                face = [self._corner(word, counts, where) for word in words[1:]]
                if len(face) < 3:
                    raise UserError(f"{where}: a face needs at least 3 corners")
                if material is None and grey is None:
                    grey = Material("", diffuse=np.full(3, 0.5))
                for triangle in triangulate(np.array([positions[corner[0]] for corner in face])):
                    corners.append([face[i] for i in triangle])
                    self.materials.append(material or grey)
        if not corners:
            raise UserError(f"{path}: there are no faces in it")
        self._gather(np.array(corners), positions, texture_coordinates, normals)

    def _read_materials(self, names, where):
        """Exporters do not escape spaces in names: all words together are tried before the single ones."""
        folder = self.path.parent
        for name in [names.replace("\\", ""), *names.split()]:
            if (folder / name).is_file():
                self._available = {**read_mtl(folder / name, folder, self.files), **self._available}
                return
        raise UserError(f"{where}: there is no file '{names}' in {folder}")

    @staticmethod
    def _corner(word, counts, where):
        """Indices from 0 of position, texture coordinates and normal; -1 where absent."""
        corner = []
        for text, count in zip([*word.split("/"), "", ""], counts):
            try:
                index = int(text or 0)
            except ValueError:
                raise UserError(f"{where}: '{word}' is not a corner of a face") from None
            if abs(index) > count or (index == 0 and not corner):
                raise UserError(f"{where}: '{word}' refers to what is not there")
            corner.append(index - 1 if index >= 0 else count + index)
        return corner

    def _gather(self, corners, positions, texture_coordinates, normals):
        def pick(values, column, absent):
            return np.array([*values, absent], float)[corners[:, :, column]]

        self.positions = pick(positions, 0, [np.nan] * 3)
        self.texture_coordinates = pick(texture_coordinates, 1, [0, 1]) * [1, -1] + [0, 1]  # v down
        self.normals = pick(normals, 2, [np.nan] * 3)
        with np.errstate(invalid="ignore", divide="ignore"):  # a normal of length 0 becomes NaN: absent
            self.normals /= np.linalg.norm(self.normals, axis=2, keepdims=True)

        has_area = np.linalg.norm(triangle_normals(self.positions), axis=1) > 0
        if not has_area.any():
            raise UserError(f"{self.path}: none of its triangles has an area")
        self.materials = [m for m, keep in zip(self.materials, has_area) if keep]
        arrays = {name: getattr(self, name)[has_area] for name in ("positions", "texture_coordinates", "normals")}
        # The front is the side of the vertex normals, if there are any.
        facing = np.nansum(arrays["normals"] * triangle_normals(arrays["positions"])[:, None], axis=(1, 2))
        for name, array in arrays.items():
            array[facing < 0] = array[facing < 0][:, [0, 2, 1]]
            setattr(self, name, array)


def triangle_normals(positions):
    """Unit normals; (0, 0, 0) for triangles without area."""
    cross = np.cross(positions[:, 1] - positions[:, 0], positions[:, 2] - positions[:, 0])
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    return np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)


def limit_reflectance(material, specular):
    """Ks counts only where asked for; both are divided by the largest channel of their sum where that exceeds 1."""
    if not specular:
        material.specular = np.zeros(3)
    largest = max(1, *(material.diffuse + material.specular))
    material.diffuse = material.diffuse / largest
    material.specular = material.specular / largest


def place_meshes(meshes, placements):
    """Surfaces in world space, one a material; placements: (index of the mesh, object-to-world matrix)."""
    pieces = {}  # material -> arrays of its instances
    for index, matrix in placements:
        mesh, linear = meshes[index], matrix[:3, :3]
        materials = np.array([id(m) for m in mesh.materials])
        positions = mesh.positions @ linear.T + matrix[:3, 3]
        normals = mesh.normals @ np.linalg.inv(linear)
        # The front is decided in object space: a mirrored instance keeps it.
        order = [0, 2, 1] if np.linalg.det(linear) < 0 else [0, 1, 2]
        for material in dict.fromkeys(mesh.materials):
            chosen = materials == id(material)
            arrays = (positions, normals, mesh.texture_coordinates)
            pieces.setdefault(material, []).append([array[chosen][:, order] for array in arrays])

    surfaces = []
    for material, parts in pieces.items():
        positions, normals, texture_coordinates = (np.concatenate(arrays) for arrays in zip(*parts))
        flat = np.broadcast_to(triangle_normals(positions)[:, None], normals.shape)
        normals = np.where(np.isnan(normals), flat, normals)
        length = np.linalg.norm(normals, axis=2, keepdims=True)
        is_flat = np.abs(normals / length - flat).max() < 1e-5
        surfaces.append(Surface(material, positions, None if is_flat else normals, texture_coordinates))
    return surfaces


# ---------------------------------------------------------------------------------------------- scenes
KEYS = {
    "the scene": {"description", "meshes", "camera", "background", "specular", "width", "height", "samples",
                  "max_path_length"},
    "meshes": {"file", "scale", "rotation", "translation"},
    "rotation": {"axis", "degrees"},
    "camera": {"position", "target", "up", "vertical_fov"},
    "background": {"radiance", "light_probe", "intensity", "rotation_degrees"},
}


def require_known_keys(path, where, entry):
    if not isinstance(entry, dict):
        raise UserError(f"{path}: {where}: expected an object {{...}}")
    unknown, known = entry.keys() - KEYS[where], ", ".join(sorted(KEYS[where]))
    if unknown:
        raise UserError(f"{path}: unknown key '{min(unknown)}' in {where}; known keys are {known}")


def triple(value):
    return np.broadcast_to(np.asarray(value, float), 3)


def placement_matrix(entry):
    """Scale, then rotation, then translation."""
    matrix = np.eye(4)
    matrix[:3, :3] = np.diag(triple(entry.get("scale", 1)))
    if "rotation" in entry:
        x, y, z = np.array(entry["rotation"]["axis"], float) / np.linalg.norm(entry["rotation"]["axis"])
        angle = math.radians(entry["rotation"]["degrees"])
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])  # Rodrigues' formula
        rotation = np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
        matrix[:3, :3] = rotation @ matrix[:3, :3]
    matrix[:3, 3] = entry.get("translation", 0)
    return matrix


def framing_camera(meshes, placements):
    """The camera of scenes without one: the bounding sphere touches the upper and lower edge of the image."""
    points = []
    for index, matrix in placements:
        corners = meshes[index].positions.reshape(-1, 3)
        low, high = corners.min(axis=0), corners.max(axis=0)
        box = np.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)])
        points.append(box @ matrix[:3, :3].T + matrix[:3, 3])
    low, high = np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
    centre, radius, fov = (low + high) / 2, np.linalg.norm(high - low) / 2, 45
    direction = np.array([0, 0.25, 1]) / math.hypot(0.25, 1)
    return {"position": list(centre + radius / math.sin(math.radians(fov / 2)) * direction),
            "target": list(centre), "up": [0, 1, 0], "vertical_fov": fov}


def read_description(path, files):
    """The content of a .json scene, its keys checked; that of a bare .obj is the mesh alone."""
    if path.suffix.lower() == ".obj":
        return {"meshes": [{"file": path.name}]}
    if path.suffix.lower() != ".json":
        raise UserError(f"{path}: a scene must be a .json or .obj file")
    try:
        root = json.loads(files.read_text(path))
    except json.JSONDecodeError as error:
        raise UserError(f"{path}:{error.lineno}: not valid JSON: {error.msg}") from None
    require_known_keys(path, "the scene", root)
    if not root.get("meshes") or not isinstance(root["meshes"], list):
        raise UserError(f"{path}: there are no meshes to be seen")
    for entry in root["meshes"]:
        require_known_keys(path, "meshes", entry)
        require_known_keys(path, "rotation", entry.get("rotation", {}))
    for key in ("camera", "background"):
        require_known_keys(path, key, root.get(key, {}))
    return root


def read_scene(path):
    """Reads a scene with all its files, in the order in which the renderer reads them, on which the hash depends."""
    path = Path(path)
    files = SourceFiles()
    root = read_description(path, files)
    try:
        meshes, indices, placements = [], {}, []
        for entry in root["meshes"]:
            file = path.parent / entry["file"]
            if file.resolve() not in indices:
                indices[file.resolve()] = len(meshes)
                meshes.append(ObjFile(file, files))
            placements.append((indices[file.resolve()], placement_matrix(entry)))

        textures = set()
        for mesh in meshes:
            for material in sorted(dict.fromkeys(mesh.materials), key=lambda m: m.refractive_index > 0):
                limit_reflectance(material, root.get("specular", False))
                if material.texture and material.texture.resolve() not in textures:
                    textures.add(material.texture.resolve())
                    files.read(material.texture)
        surfaces = place_meshes(meshes, placements)

        background = root.get("background", {})
        light_probe = path.parent / background["light_probe"] if "light_probe" in background else None
        if light_probe:
            files.read(light_probe)
        radiance = background.get("intensity", 1) if light_probe else background.get("radiance", 0)
        if path.suffix.lower() == ".obj" and not any(s.material.emission.any() for s in surfaces):
            radiance = 1  # a bare mesh without lights is lit by a white sky
        camera = {"up": [0, 1, 0], "vertical_fov": 45,
                  **(root.get("camera") or framing_camera(meshes, placements))}
        camera = {key: np.asarray(camera[key], float) for key in ("position", "target", "up", "vertical_fov")}
        return Scene(surfaces, camera,
                     triple(radiance), light_probe, float(background.get("rotation_degrees", 0)),
                     root.get("width", 512), root.get("height", 512), root.get("max_path_length", 8),
                     f"{files.hash:x}")
    except KeyError as error:
        raise UserError(f"{path}: the key {error} is missing") from None
    except (TypeError, ValueError, np.linalg.LinAlgError) as error:
        raise UserError(f"{path}: a value has the wrong type or no meaning: {error}") from None
