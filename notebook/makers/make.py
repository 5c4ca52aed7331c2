"""Computes the files in assets/ that follow from formulas: meshes, textures, volumes, light probes, and scenes with many lamps. Other
scenes, materials and meshes of a few triangles are edited by hand.

The same meshes come out on every machine: numbers are rounded to few decimals.
"""
import io
import math
import struct

import numpy as np
from makers import images, lamps, volumes
from makers.shapes import direction, heart, pumpkin, rounded_cylinder, row_of_balls, sphere, torus
from PIL import Image
from project import ROOT, Parser, UserError, write_bytes

MESHES = {  # name -> parts
    "torus": lambda: [torus("porcelain")],
    "sphere": lambda: [sphere("white")],
    "numbered_ball": lambda: [sphere("numbered_squares", times_around=2)],
    "rough_balls": lambda: (
        row_of_balls([f"metal_{i}" for i in range(5)], 0.3, 0.66, -0.35)
        + row_of_balls([f"plastic_{i}" for i in range(5)], 0.22, 0.56, 0.45)
    ),
    "hall": lamps.hall,
    "lamp_cluster": lamps.lamp_cluster,
    "tower": lambda: lamps.building(30, 7),
    "house": lambda: lamps.building(16, 6),
    "street_lamp": lamps.street_lamp,
    "ground": lamps.ground,
    "rounded_cylinder": lambda: [rounded_cylinder("white")],
    "heart": heart,
    "orange_pumpkin": lambda: pumpkin(10, 0.74),
    "green_pumpkin": lambda: pumpkin(14, 0.6),
}
SCENES = {"lamps": lamps.lamps_scene, "city": lamps.city_scene}
TEXTURES = {"numbered_squares": (256, 256), "planks": (300, 200), "panes": (96, 160)}  # width and height
VOLUMES = ("smoke",)
LIGHT_PROBES = {"sky": (256, 128), "clear_sky": (512, 256), "softboxes": (256, 128)}


def numbers(values):
    """Decimals without trailing zeros; -0 becomes 0."""
    texts = (f"{x:.5f}".rstrip("0").rstrip(".") for x in values)
    return " ".join("0" if text == "-0" else text for text in texts)


def encode_obj(name, parts):
    """The text of an OBJ file. A textured mesh has one part."""
    obj, material = [f"mtllib {name}.mtl"], None
    first_position = first_normal = 1  # OBJ counts from 1, across all parts
    for part in parts:
        obj += [f"v {numbers(p)}" for p in part.positions]
        obj += [f"vt {numbers((part.times_around * u, v))}" for u, v in part.texture_coordinates if part.times_around]
        obj += [f"vn {numbers(n)}" for n in part.normals]
        if part.material != material:
            material = part.material
            obj.append(f"usemtl {material}")
        for k, triangle in enumerate(part.triangles):
            corners = []
            for i, vertex in enumerate(triangle):
                corner = str(first_position + vertex)
                if part.times_around:
                    corner += f"/{1 + part.texture_triangles[k][i]}"
                if part.normals:
                    corner += ("/" if part.times_around else "//") + str(first_normal + vertex)
                corners.append(corner)
            obj.append("f " + " ".join(corners))
        first_position += len(part.positions)
        first_normal += len(part.normals)
    return ("\n".join(obj) + "\n").encode()


def encode_png(width, height, pixel):
    pixels = [[[round(255 * c) for c in pixel(x, y)] for x in range(width)] for y in range(height)]
    stream = io.BytesIO()
    Image.fromarray(np.array(pixels, np.uint8)).save(stream, "png")
    return stream.getvalue()


def encode_hdr(width, height, radiance):
    """Radiance's RGBE format, equirectangular: the centre of the image points towards -Z, its right half towards +X, its top
    +Y."""
    content = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode()
    for y in range(height):
        pixels = []
        for x in range(width):
            azimuth = math.pi - 2 * math.pi * ((x + 0.5) / width - 0.5)
            rgb = radiance(direction(math.pi * (y + 0.5) / height, azimuth))
            exponent = math.frexp(max(rgb))[1]
            pixels.append([min(255, round(c * 2 ** (8 - exponent))) for c in rgb] + [exponent + 128])
        content += struct.pack(">BBH", 2, 2, width)  # each row is four planes, in runs of at most 128 bytes
        for plane in zip(*pixels):
            for run in (plane[k : k + 128] for k in range(0, width, 128)):
                content += bytes([len(run), *run])
    return content


def make_files():
    """Path below assets/ -> bytes."""
    return (
        {f"meshes/{name}.obj": encode_obj(name, parts()) for name, parts in MESHES.items()}
        | {f"scenes/{name}.json": scene() for name, scene in SCENES.items()}
        | {f"textures/{name}.png": encode_png(*size, getattr(images, name)) for name, size in TEXTURES.items()}
        | {f"volumes/{name}.vol": volumes.encode_vol(getattr(volumes, name)()) for name in VOLUMES}
        | {f"light_probes/{name}.hdr": encode_hdr(*size, getattr(images, name)) for name, size in LIGHT_PROBES.items()}
    )


def is_same(file, content):
    """Whether a file has this content. PNG files are compared by their pixels, since the compressed bytes depend on zlib's
    version."""
    if file.suffix == ".png" and file.is_file():
        return np.array_equal(*(np.asarray(Image.open(stream).convert("RGB")) for stream in (file, io.BytesIO(content))))
    return file.is_file() and file.read_bytes() == content


def main():
    parser = Parser("./lab notebook assets", __doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; name the first file that is another one")
    is_check = parser.parse_args().check
    for name, content in make_files().items():
        file = ROOT / "assets" / name
        if is_same(file, content):
            continue
        if is_check:
            raise UserError(f"assets/{name}: is not as its formula makes it; run `./lab notebook assets` or undo the change")
        write_bytes(file, content)
