"""The files below assets/, written into a dictionary: the same bytes on every machine."""
import json
import math

from assets.encoders import encode_hdr, encode_png
from assets.shapes import direction

files = {}  # path below assets/ -> bytes


def numbers(values):
    """Decimals without trailing zeros; -0 becomes 0."""
    texts = (f"{x:.5f}".rstrip("0").rstrip(".") for x in values)
    return " ".join("0" if text == "-0" else text for text in texts)


def write_mesh(name, parts, materials):
    """meshes/NAME.obj and .mtl; materials: name -> {MTL keyword: text}."""
    obj, material = [f"mtllib {name}.mtl"], None
    first_position = first_texture_coordinate = first_normal = 1  # OBJ counts from 1, across all parts
    for part in parts:
        textured = "map_Kd" in materials[part.material]
        obj += [f"v {numbers(p)}" for p in part.positions]
        obj += [f"vt {numbers(t)}" for t in part.texture_coordinates if textured]
        obj += [f"vn {numbers(n)}" for n in part.normals]
        if part.material != material:
            material = part.material
            obj.append(f"usemtl {material}")
        for k, triangle in enumerate(part.triangles):
            corners = []
            for i, vertex in enumerate(triangle):
                corner = str(first_position + vertex)
                if textured:
                    corner += f"/{first_texture_coordinate + part.texture_triangles[k][i]}"
                if part.normals:
                    corner += ("/" if textured else "//") + str(first_normal + vertex)
                corners.append(corner)
            obj.append("f " + " ".join(corners))
        first_position += len(part.positions)
        first_texture_coordinate += len(part.texture_coordinates) if textured else 0
        first_normal += len(part.normals)
    used = dict.fromkeys(part.material for part in parts)
    mtl = ["\n".join([f"newmtl {m}"] + [f"{key} {text}" for key, text in materials[m].items()]) for m in used]
    files[f"meshes/{name}.obj"] = ("\n".join(obj) + "\n").encode()
    files[f"meshes/{name}.mtl"] = ("\n\n".join(mtl) + "\n").encode()


def mesh(name, **placement):
    """One entry of a scene's list of meshes."""
    return {"file": f"../meshes/{name}.obj", **placement}


def turn(axis, degrees):
    return {"axis": axis, "degrees": degrees}


def camera(position, target, vertical_fov):
    return {"position": position, "target": target, "up": [0, 1, 0], "vertical_fov": vertical_fov}


def write_scene(name, description, meshes, view, **keys):
    """scenes/NAME.json with one line a mesh."""
    lines = [f'    "description": {json.dumps(description)}']
    lines.append('    "meshes": [\n        ' + ",\n        ".join(map(json.dumps, meshes)) + "\n    ]")
    lines += [f'    "{key}": {json.dumps(value)}' for key, value in {"camera": view, **keys}.items()]
    files[f"scenes/{name}.json"] = ("{\n" + ",\n".join(lines) + "\n}\n").encode()


def write_png(name, width, height, pixel):
    files[f"textures/{name}.png"] = encode_png(width, height, pixel)


def write_light_probe(name, width, height, radiance):
    """light_probes/NAME.hdr, equirectangular; radiance(d): linear RGB that comes from direction d. The centre
    of the image is towards -Z, its right half towards +X, its top +Y."""
    def pixel(x, y):
        azimuth = math.pi - 2 * math.pi * ((x + 0.5) / width - 0.5)
        return radiance(direction(math.pi * (y + 0.5) / height, azimuth))

    files[f"light_probes/{name}.hdr"] = encode_hdr(width, height, pixel)
