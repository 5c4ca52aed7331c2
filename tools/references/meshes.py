"""Reads .obj and .mtl files in Python, for tools that hand them to other renderers: see scenes.py."""
import math
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from project import UserError


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
        self._available, self._libraries, self._is_noted = {}, set(), False
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
                material = self._available.get(name)
                if material is None:
                    self._note_missing(f"{where}: there is no material '{name}'")
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
                if folder / name not in self._libraries:
                    self._libraries.add(folder / name)
                    self._available = {**read_mtl(folder / name, folder, self.files), **self._available}
                return
        self._note_missing(f"{where}: there is no material file '{names}'")

    def _note_missing(self, what):
        """The first thing that is missing is named, as the chapters do."""
        if not self._is_noted:
            print(f"note: {what}: faces without a material are drawn in grey", file=sys.stderr)
        self._is_noted = True

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
