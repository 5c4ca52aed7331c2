"""Reads the .obj and .mtl files of chapters, for tools that pass them to other renderers: see scenes.py."""
import sys

import numpy as np

from material_keywords import KEYWORDS


class Material:
    """Has the members of Material in shaders/interface.h. Albedos are linear and sum to at most 1. Compared and hashed by identity: two files
    may use the same name."""

    def __init__(self, name, **members):
        self.name = name
        for keyword in KEYWORDS:
            if keyword.member:
                setattr(self, keyword.member, np.zeros(3) if keyword.count == 3 else keyword.default)
        self.refractive_index = 0.0  # 0 for an opaque surface
        self.absorption = np.zeros(3)  # -ln Tf per unit of world length
        self.texture = None  # its path
        self.roughness = 0.0  # alpha of the GGX distribution; 0 without microfacets
        self.metalness = 0.0
        self.coat_index = 1.5  # for an opaque surface with microfacets
        vars(self).update(members)

    def equals(self, other):
        """Whether both look the same, whatever their names."""
        return all(np.array_equal(value, getattr(other, key)) for key, value in vars(self).items() if key != "name")


NUMBERS = {keyword.name: keyword.count for keyword in KEYWORDS if keyword.count}


def to_floats(words, count):
    """The first numbers in a line, rounded to 32 bits as in the renderer."""
    values = np.array([float(word) for word in words[:count]], np.float32).astype(float)
    if len(values) < count or not np.isfinite(values).all():
        raise ValueError(f"expected {count} finite numbers, found '{' '.join(words[:count])}'")
    return values


def name_after_keyword(line):
    """The rest of a line: names may contain spaces."""
    return line.split("#")[0].split(None, 1)[1].rstrip()


def read_mtl(path, texture_folder, files):
    """The materials of an MTL file by name; if a name occurs twice, the first one counts."""
    statements = []  # one dictionary per material
    for line in files.read_text(path).splitlines():
        words = line.split("#")[0].split()
        keyword = words[0] if words else ""
        if keyword == "newmtl":
            statements.append({"newmtl": name_after_keyword(line)})
        elif keyword in NUMBERS:
            numbers = words[2:] if words[1:2] == ["-halo"] else words[1:]  # it has no effect
            count = NUMBERS[keyword]
            statements[-1]["Tf" if keyword == "Kt" else keyword] = to_floats(
                numbers * count if len(numbers) == 1 else numbers, count
            )
        elif keyword == "map_Kd":
            name = name_after_keyword(line)
            statements[-1]["map_Kd"] = words[-1] if name.startswith("-") else name  # options have no effect

    materials = {}
    for stated in statements:
        members = {
            keyword.member: stated[keyword.name] if keyword.count == 3 else float(stated[keyword.name][0])
            for keyword in KEYWORDS
            if keyword.member and keyword.name in stated
        }
        material = Material(stated["newmtl"], **members)
        if "map_Kd" in stated:
            material.diffuse_albedo = stated.get("Kd", np.ones(3))
            material.texture = texture_folder / stated["map_Kd"].replace("\\", "/")
        opacity = stated["d"][0] if "d" in stated else 1 - stated.get("Tr", [0])[0]
        if opacity < 1:
            material.refractive_index = float(stated.get("Ni", [1])[0])
            transmittance = stated.get("Tf", np.ones(3))
            material.absorption = np.maximum(0, -np.log(transmittance))
        if "Pr" in stated and not (opacity < 1 and (stated["Pr"][0] < 0.01 or material.refractive_index == 1)):
            material.roughness = max(float(stated["Pr"][0]), 0.01) ** 2
            material.metalness = float(stated.get("Pm", [0])[0])
            material.coat_index = float(stated.get("Ni", [1.5])[0])
            for keyword in KEYWORDS:
                if keyword.is_lobe:  # microfacets replace it
                    setattr(material, keyword.member, np.zeros(3))
        materials.setdefault(material.name, material)
    return materials


def triangulate(polygon):
    """Triples of corner indices: a fan, as in the renderer for convex polygons."""
    fan = [(0, i, i + 1) for i in range(1, len(polygon) - 1)]
    normals = np.array([np.cross(polygon[b] - polygon[0], polygon[c] - polygon[0]) for _, b, c in fan])
    if (normals @ normals.sum(axis=0) < 0).any():
        raise ValueError("a face is not convex: let the program that made it triangulate it")
    return fan


class ObjFile:
    """The triangles of an OBJ file in object space: arrays [triangle, corner], normals NaN where there are none.

    `materials` is an MTL file that stands for those that the mesh names; a single material in it is that of all faces.
    Triangles without area are dropped, and corners ordered counter-clockwise seen from the front."""

    def __init__(self, path, files, materials=None):
        self.path, self.files = path, files
        self.materials = []  # of the triangles
        self.libraries = {materials: None} if materials else {}  # the MTL files that were read, in order
        self._available, self._is_noted = {}, False
        positions, texture_coordinates, normals, corners = [], [], [], []
        material = grey = None
        text = files.read_text(path)
        if materials:
            self._available = read_mtl(materials, materials.parent, files)
        only = next(iter(self._available.values())) if len(self._available) == 1 else None
        for number, line in enumerate(text.splitlines(), 1):
            words = line.split("#")[0].split()
            keyword, where = words[0] if words else "", f"{path}:{number}"
            if keyword == "v":
                positions.append(to_floats(words[1:], 3))
            elif keyword == "vn":
                normals.append(to_floats(words[1:], 3))
            elif keyword == "vt":
                texture_coordinates.append(to_floats([*words[1:], "0"], 2))
            elif keyword == "mtllib" and not materials:
                self._read_materials(name_after_keyword(line), where)
            elif keyword == "usemtl" and not only:
                name = name_after_keyword(line)
                material = self._available.get(name)
                if material is None:
                    self._note_missing(f"{where}: there is no material '{name}'")
            elif keyword == "f":
                counts = (len(positions), len(texture_coordinates), len(normals))
                face = [self._corner(word, counts) for word in words[1:]]
                if material is None and grey is None:
                    grey = only or Material("", diffuse_albedo=np.full(3, 0.5))
                for triangle in triangulate(np.array([positions[corner[0]] for corner in face])):
                    corners.append([face[i] for i in triangle])
                    self.materials.append(material or grey)
        self._gather(np.array(corners), positions, texture_coordinates, normals)

    def _read_materials(self, names, where):
        """Exporters do not escape spaces in names: all words together are tried before single ones."""
        folder = self.path.parent
        for name in [names.replace("\\", ""), *names.split()]:
            if (folder / name).is_file():
                if folder / name not in self.libraries:
                    self.libraries[folder / name] = None
                    self._available = {**read_mtl(folder / name, folder, self.files), **self._available}
                return
        self._note_missing(f"{where}: there is no material file '{names}'")

    def _note_missing(self, what):
        """Reports the first thing that is missing, as the chapters do."""
        if not self._is_noted:
            print(f"note: {what}: faces without a material are drawn in grey", file=sys.stderr)
        self._is_noted = True

    @staticmethod
    def _corner(word, counts):
        """Indices from 0 of position, texture coordinates and normal; -1 where absent."""
        indices = [int(text or 0) for text in [*word.split("/"), "", ""]]
        return [index - 1 if index >= 0 else count + index for index, count in zip(indices, counts)]

    def _gather(self, corners, positions, texture_coordinates, normals):
        def pick(values, column, absent):
            return np.array([*values, absent], float)[corners[:, :, column]]

        self.positions = pick(positions, 0, [np.nan] * 3)
        self.texture_coordinates = pick(texture_coordinates, 1, [0, 1]) * [1, -1] + [0, 1]  # v down
        self.normals = pick(normals, 2, [np.nan] * 3)
        with np.errstate(invalid="ignore", divide="ignore"):  # a normal of length 0 becomes NaN: absent
            self.normals /= np.linalg.norm(self.normals, axis=2, keepdims=True)

        has_area = np.linalg.norm(triangle_normals(self.positions), axis=1) > 0
        self.materials = [m for m, keep in zip(self.materials, has_area) if keep]
        arrays = {name: getattr(self, name)[has_area] for name in ("positions", "texture_coordinates", "normals")}
        # The front is the side of the vertex normals, if there are any.
        facing = np.nansum(arrays["normals"] * triangle_normals(arrays["positions"])[:, None], axis=(1, 2))
        for name, array in arrays.items():
            array[facing < 0] = array[facing < 0][:, [0, 2, 1]]
            setattr(self, name, array)


def materials_in_order(mesh):
    """The materials of a mesh in the renderer's order: that in which its faces use them, glass after all others."""
    return sorted(dict.fromkeys(mesh.materials), key=lambda material: material.refractive_index > 0)


def triangle_normals(positions):
    """Unit normals; (0, 0, 0) for triangles without area."""
    cross = np.cross(positions[:, 1] - positions[:, 0], positions[:, 2] - positions[:, 0])
    length = np.linalg.norm(cross, axis=1, keepdims=True)
    return np.divide(cross, length, out=np.zeros_like(cross), where=length > 0)
