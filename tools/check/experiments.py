"""Small experiments that isolate one thing each: experiments.json in a chapter's folder lists those that it uses.

An experiment has points: tiny scenes of a few plates, lamps or pieces of glass that differ in a single thing. The camera looks at one
small spot, so that all pixels show the same and a picture is one number: its mean, with an error from the spread of the pixels. It
is compared with what the chapter's own shader finds there, as recorded in assets/expected.
"""
import json
import math
import struct
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from project import CHAPTERS, ROOT, course, read_json
from references.images import read_rgb
from report.measurement import new_case, run_case

EXPERIMENTS = "experiments.json"  # in the chapters' folders
OF_THE_SCENE = ("specular", "multiple_scattering", "fog")  # keys of a scene file that an experiment may also have
SIZE = 32  # pixels per row and per column
CAMERA = {"from": [0.0, 1.2, 1.2], "to": [0.0, 0.0, 0.0], "fov": 3.0}
BLOCKS = 16  # of pixels: their spread gives the error of a variance


@dataclass
class Point:
    """One scene of an experiment, and how it is rendered."""

    scene: dict
    at: str  # what distinguishes it, in words
    x: float = None  # the same as a number, if there is one
    options: str = ""
    samples: int = 64
    channel: int = None  # of the colours, or all of them


@dataclass
class Experiment:
    name: str
    subject: str  # the light that it shows
    varies: str  # what distinguishes its points
    points: list
    quantity: dict = field(default_factory=dict)  # functions of x that a law may follow, in words
    when: dict = field(default_factory=dict)  # name of another experiment -> whether it must have been right
    decides: bool = False  # whether it also runs for shaders whose pictures look right
    is_of_noise: bool = False  # whether it decides about noise, too


@dataclass
class Sight:
    """What a shader shows at a point."""

    mean: float
    error: float  # standard error of the mean
    noise: float  # variance of a single sample
    noise_error: float
    rays: float  # of a sample
    invalid: int = 0  # samples that are infinite or not a number


def known_sights(entry):
    """What the chapter's own shader shows, as a list of Sight, from lists in its file of assets/expected."""
    return [Sight(*values) for values in zip(*(entry[key] for key in ("mean", "error", "noise", "noise_error", "rays")))]


def merged(base, change):
    """A dictionary with the changes of `change`, at any depth; None removes an entry."""
    result = dict(base)
    for key, value in change.items():
        result[key] = merged(result.get(key, {}), value) if isinstance(value, dict) else value
    return {key: value for key, value in result.items() if value is not None}


def experiment_files():
    """Chapter -> its experiments.json, for chapters that have one."""
    files = {chapter: ROOT / "chapters" / CHAPTERS[chapter] / EXPERIMENTS for chapter in course()}
    return {chapter: read_json(file) for chapter, file in files.items() if file.exists()}


def experiments_of(chapter):
    """Name -> Experiment, for those that a chapter uses, in its order. Each experiment is described in one chapter only."""
    files = experiment_files()
    if chapter not in files:
        return {}
    described = {name: says for file in files.values() for name, says in file.get("experiments", {}).items()}
    return {name: experiment(name, described[name], files[chapter].get("samples", 64)) for name in files[chapter]["uses"]}


def experiment(name, says, samples):
    points = [
        Point(
            merged(says["scene"], point.get("scene", {})),
            point["at"],
            point.get("x"),
            " ".join(filter(None, [says.get("options"), point.get("options")])),
            point.get("samples", says.get("samples", samples)),
            point.get("channel"),
        )
        for point in says["points"]
    ]
    rest = {key: says[key] for key in ("quantity", "when", "decides", "is_of_noise") if key in says}
    return Experiment(name, says["subject"], says.get("varies", ""), points, **rest)


# ---------------------------------------------------------------------------------------------- scenes
def basis(normal):
    """Two unit vectors that form a right-handed frame with a normal."""
    normal = np.array(normal, float) / np.linalg.norm(normal)
    tangent = np.cross([0.0, 0.0, 1.0] if abs(normal[2]) < 0.9 else [1.0, 0.0, 0.0], normal)
    tangent /= np.linalg.norm(tangent)
    return tangent, np.cross(normal, tangent)


def plate(says):
    """The corners of a rectangle. If given by angles (polar, azimuth in degrees) and a distance, it faces the origin, unless it
    is turned."""
    if "polar" in says:
        polar, azimuth = math.radians(says["polar"]), math.radians(says.get("azimuth", 0.0))
        away = np.array([math.sin(polar) * math.cos(azimuth), math.cos(polar), math.sin(polar) * math.sin(azimuth)])
        side = np.cross(away, [0.0, 0.0, 1.0])
        turn = math.radians(says.get("turned", 0.0))
        centre, normal = says["distance"] * away, -away * math.cos(turn) + side * math.sin(turn)
    else:
        centre, normal = np.array(says["centre"], float), says["faces"]
    width, height = np.broadcast_to(says["size"], 2)
    tangent, other = basis(normal)
    return [[centre + x * width / 2 * tangent + y * height / 2 * other for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]]


def box(says):
    """The six faces of a box, rotated about the z-axis by an angle in degrees."""
    size, centre, angle = (
        np.array(says["box"], float),
        np.array(says.get("centre", [0, 0, 0]), float),
        math.radians(says.get("turn", 0.0)),
    )
    turn = np.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]])
    faces = []
    for axis in range(3):
        for sign in (-1, 1):
            normal = sign * np.eye(3)[axis]
            tangent, other = basis(normal)
            faces.append(
                [centre + turn @ (size / 2 * (normal + x * tangent + y * other)) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            )
    return faces


def ball(says, rows=8, columns=16):
    """The faces of a ball seen from inside."""

    def corner(row, column):
        theta, phi = math.pi * row / rows, 2 * math.pi * column / columns
        return says["ball"] * np.array([math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)])

    faces = [
        [corner(r, c), corner(r, c + 1), corner(r + 1, c + 1), corner(r + 1, c)] for r in range(rows) for c in range(columns)
    ]
    faces = [[p for i, p in enumerate(face) if math.dist(p, face[i - 1]) > 1e-6 * says["ball"]] for face in faces]  # at the poles
    return [face[::-1] for face in faces]


def faces_of(says):
    if "corners" in says:
        return [np.array(face, float) for face in says["corners"]]
    return (ball if "ball" in says else box if "box" in says else plate)(says)


def colour(value):
    return " ".join(f"{number:.9g}" for number in np.broadcast_to(value, 3))


def grid_along_z(densities):
    """A file with a grid of densities that differ along z alone."""
    header = struct.pack("<4s5i6f", b"VOL\3", 1, 1, 1, len(densities), 1, 0, 0, 0, 1, 1, 1)
    return header + np.array(densities, "<f4").tobytes()


def light_probe(rows):
    """A picture of all directions with one grey value, a power of two, for each row, from top to bottom."""
    columns = 2 * len(rows)
    pixels = [bytes([128, 128, 128, 129 + int(math.log2(value))]) * columns for value in rows]
    return f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {len(rows)} +X {columns}\n".encode() + b"".join(pixels)


def file_of(says, assets, write, file):
    """An asset that an experiment names, or else a file of its own."""
    if isinstance(says, str):
        return str(ROOT / "assets" / assets / says)
    file.write_bytes(write(says))
    return str(file)


def write_mesh(pieces, folder, name):
    """Writes pieces of a scene as a mesh; returns the name of its file."""
    vertices, normals, faces, materials = [], [], [], []
    for index, says in enumerate(pieces):
        materials += [
            f"newmtl m{index}",
            f"Kd {colour(0 if 'glass' in says else says.get('albedo', 0))}",
            f"Ke {colour(says.get('emits', 0))}",
        ]
        if "glass" in says:
            materials += ["d 0", f"Ni {says['glass']}", f"Tf {colour(says.get('clear', 1))}"]
        if "glossy" in says:
            materials += [f"Ks {colour(says['glossy'])}", f"Ns {says['exponent']}"]
        if "rough" in says:
            materials += [f"Pr {says['rough']}", f"Pm {says.get('metal', 0)}"]
        faces.append(f"usemtl m{index}")
        normal = ""
        if "vertex_normals" in says:
            normals.append("vn " + " ".join(map(str, says["vertex_normals"])))
            normal = f"//{len(normals)}"
        for face in faces_of(says):
            faces.append("f " + " ".join(f"{len(vertices) + i}{normal}" for i in range(1, len(face) + 1)))
            vertices += [f"v {p[0]:.9g} {p[1]:.9g} {p[2]:.9g}" for p in face]
    (folder / f"{name}.mtl").write_text("\n".join(materials) + "\n")
    (folder / f"{name}.obj").write_text("\n".join([f"mtllib {name}.mtl", *vertices, *normals, *faces]) + "\n")
    return f"{name}.obj"


def write_scene(scene, folder, name):
    """Writes a scene and its meshes, one of them for each piece with a medium; returns the scene's file."""
    pieces = {key: says for key, says in scene.items() if key not in ("camera", "background", *OF_THE_SCENE)}
    bodies = {key: says for key, says in pieces.items() if "medium" in says}
    meshes = [{"file": write_mesh([says for key, says in pieces.items() if key not in bodies], folder, name)}] + [
        {"file": write_mesh([says], folder, f"{name}_{key}"), "medium": says["medium"]} for key, says in bodies.items()
    ]
    camera = CAMERA | scene.get("camera", {})
    up = [0, 1, 0] if camera["from"][0] != camera["to"][0] or camera["from"][2] != camera["to"][2] else [0, 0, 1]
    background = scene.get("background", 0)
    if isinstance(background, dict):
        probe = file_of(background["light_probe"], "light_probes", light_probe, folder / f"{name}.hdr")
        background = background | {"light_probe": probe}
    others = {key: scene[key] for key in OF_THE_SCENE if key in scene}
    if "density" in others.get("fog", {}):
        grid = file_of(others["fog"]["density"], "volumes", grid_along_z, folder / f"{name}.vol")
        others["fog"] = others["fog"] | {"density": grid}
    file = folder / f"{name}.json"
    file.write_text(
        json.dumps(
            {
                "description": "An experiment of ./lab check",
                "meshes": meshes,
                **others,
                "camera": {"position": camera["from"], "target": camera["to"], "up": up, "vertical_fov": camera["fov"]},
                "background": background if isinstance(background, dict) else {"radiance": [background] * 3},
            }
        )
    )
    return file


# ---------------------------------------------------------------------------------------------- measuring
def look(image, report, samples, channel=None):
    """What a picture shows of a shader. If a few bright pixels dominate the variance, its upper bound is used. Pixels that a filter has
    made infinite, or not a number, count as invalid samples do."""
    pixels = (image.mean(axis=2) if channel is None else image[..., channel]).ravel()
    invalid = int((~np.isfinite(pixels)).sum())
    pixels = np.where(np.isfinite(pixels), pixels, 0.0)
    variance = float(pixels.var(ddof=1))
    spread = float(np.std([block.var(ddof=1) for block in np.array_split(pixels, BLOCKS)], ddof=1) / math.sqrt(BLOCKS))
    return Sight(
        float(pixels.mean()),
        math.sqrt((variance + 2 * spread) / pixels.size),
        variance * samples,
        spread * samples,
        report["rows"][-1]["rays"] / samples / pixels.size,
        report["invalid_samples"] + invalid,
    )


def together(sights):
    """What several pictures of a point show. Uses their spread if it exceeds that of the pixels, whose errors may be
    correlated."""

    def mean(key):
        return float(np.mean([getattr(sight, key) for sight in sights]))

    count = len(sights)
    spread = float(np.std([sight.mean for sight in sights], ddof=1)) if count > 1 else 0.0
    return Sight(
        mean("mean"),
        max(mean("error"), spread) / math.sqrt(count),
        mean("noise"),
        mean("noise_error") / math.sqrt(count),
        mean("rays"),
        sum(sight.invalid for sight in sights),
    )


def pictures(program, points, settings, seed, batch, repeats=1):
    """What a program shows at each of these points in each of `repeats` pictures, one after another: a list of Sight for each
    point."""
    sights = []
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "picture.exr"
        for index, point in enumerate(points):
            scene = write_scene(point.scene, Path(folder), f"point_{index}")
            case = new_case(scene, None, point.at, program, point.options.split()) | {"width": SIZE, "height": SIZE}
            seen = []
            for turn in range(repeats):
                report = run_case(
                    case,
                    settings,
                    ["--samples", point.samples, "--seed", seed + index * repeats + turn, "--output", picture],
                    batch.run,
                )
                seen.append(look(read_rgb(picture), report, point.samples, point.channel))
            sights.append(seen)
    return sights
