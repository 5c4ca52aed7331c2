"""What Cycles and LuxCore are compared on: surfaces that reflect diffusely, lamps of triangles, and clear smooth glass."""
from project import UserError


def refuse_what_peers_lack(scene, name):
    """Raises UserError if a scene has more."""
    materials = [surface.material for surface in scene.surfaces]
    lacks = {
        "microfacets of our formula": any(material.roughness > 0 for material in materials),
        "a Phong lobe": any(material.specular.any() for material in materials),
        "glass that absorbs": any(material.absorption.any() for material in materials),
        "textures": any(material.texture for material in materials),
        "a background": scene.light_probe or scene.background.any(),
        "fog": scene.fog,
        "a lens": scene.camera["aperture_diameter"] > 0,
    }
    found = [what for what, is_there in lacks.items() if is_there]
    if found:
        raise UserError(f"{name} is not compared on scenes with {' and '.join(found)}")
