"""A scene with other albedos, written to a folder of its own: for ./lab solve, and to measure derivatives."""
import json

from project import read_json
from references.meshes import ObjFile, materials_in_order, name_after_keyword
from references.scenes import SourceFiles, mesh_files


def meshes_of(scene):
    """The meshes of a .json scene in the renderer's order, each once, and for each placement the index of its mesh."""
    files = [mesh_files(scene, entry) for entry in read_json(scene)["meshes"]]
    keys = [tuple(file and file.resolve() for file in pair) for pair in files]
    first = {key: pair for key, pair in zip(reversed(keys), reversed(files))}
    order = list(dict.fromkeys(keys))
    return [ObjFile(first[key][0], SourceFiles(), first[key][1]) for key in order], [order.index(key) for key in keys]


def materials_of(scene):
    """The materials of a .json scene, in the order of --derivative."""
    return [material for mesh in meshes_of(scene)[0] for material in materials_in_order(mesh)]


def absolute(value, folder):
    """A value of a scene file whose names of files do not depend on where it lies."""
    if isinstance(value, dict):
        return {key: absolute(each, folder) for key, each in value.items()}
    if isinstance(value, list):
        return [absolute(each, folder) for each in value]
    return str((folder / value).resolve()) if isinstance(value, str) and (folder / value).is_file() else value


def with_albedos(library, albedos):
    """The text of an .mtl file with these values of Kd by name, to be read from another folder."""
    lines, name = [], None
    for line in SourceFiles().read_text(library).splitlines():
        keyword = next(iter(line.split("#")[0].split()), "")
        if keyword == "newmtl":
            name = name_after_keyword(line)
            if name in albedos:
                line += "\nKd " + " ".join(f"{value:.9g}" for value in albedos[name])
        elif keyword == "Kd" and name in albedos:
            continue
        elif keyword == "map_Kd":
            line = f"map_Kd {library.parent.resolve() / name_after_keyword(line)}"
        lines.append(line)
    return "\n".join(lines) + "\n"


def write_scene(scene, albedos, folder):
    """Writes a .json scene with these albedos, {name of a material: three numbers}. Returns the new scene's file."""
    root, (meshes, indices) = absolute(read_json(scene), scene.parent), meshes_of(scene)
    for i, mesh in enumerate(meshes):
        texts = (with_albedos(library, albedos) for library in mesh.libraries)
        (folder / f"{i}.mtl").write_text("".join(texts), encoding="utf-8", errors="surrogateescape")
    for entry, index in zip(root["meshes"], indices):
        entry["materials"] = f"{index}.mtl"
    file = folder / "scene.json"
    file.write_text(json.dumps(root), encoding="utf-8")
    return file
