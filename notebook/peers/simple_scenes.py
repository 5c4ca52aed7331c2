"""What Cycles and LuxCore are compared on: surfaces that reflect diffusely, lamps of triangles, clear smooth glass, and fog."""
import numpy as np
from project import UserError


def refuse_what_peers_lack(scene, name):
    """Raises UserError if a scene has more."""
    materials = [surface.material for surface in scene.surfaces]
    lacks = {
        "microfacets of our formula": any(material.roughness > 0 for material in materials),
        "a Phong lobe": any(material.specular_albedo.any() for material in materials),
        "glass that absorbs": any(material.absorption.any() for material in materials),
        "media of meshes": any(surface.is_open or "extinction" in (surface.inside or {}) for surface in scene.surfaces),
        "textures": any(material.texture for material in materials),
        "a background": scene.light_probe or scene.background.any(),
        "a lens": scene.camera["aperture_diameter"] > 0,
    }
    found = [what for what, is_there in lacks.items() if is_there]
    if found:
        raise UserError(f"{name} is not compared on scenes with {' and '.join(found)}")


def corners(surface):
    """Lists of the corners of all triangles, of the triangles' three indices into them, and of unit normals or None."""
    normals = surface.normals
    if normals is not None:
        normals = (normals / np.linalg.norm(normals, axis=2, keepdims=True)).reshape(-1, 3).tolist()
    positions = surface.positions.reshape(-1, 3).tolist()
    return positions, np.arange(len(positions)).reshape(-1, 3).tolist(), normals


def camera_matrix(camera):
    """From the camera to the world, where the camera looks along -z and its y is up."""
    back = camera["position"] - camera["target"]
    back = back / np.linalg.norm(back)
    right = np.cross(camera["up"], back)
    right = right / np.linalg.norm(right)
    matrix = np.eye(4)
    matrix[:3] = np.stack([right, np.cross(back, right), back, camera["position"]], axis=1)
    return matrix
