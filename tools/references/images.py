"""Reference images: finding and reading them, and the error of another image."""
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from project import ROOT, UserError
from references.exr import Exr, read_attributes

FOLDERS = [ROOT / "assets/references", ROOT / "output/references"]  # where ./lab reference writes


@dataclass
class Reference:
    """Arrays [row, column, channel] of the mean of all samples and of that mean's variance, 0 if unknown."""

    mean: np.ndarray
    variance: np.ndarray
    attributes: dict

    @property
    def freedom(self):
        """Degrees of freedom of the variance."""
        return max(int(self.attributes.get("batches", 2)) - 1, 1)

    @property
    def weights(self):
        """The weights of squared differences in rel_mse, as in the chapters: 1 / (r^2 + 0.01 mean(r)^2)."""
        mean = self.mean.mean()
        return 1 / (self.mean**2 + 0.01 * mean**2) if mean > 0 else np.ones_like(self.mean)

    @property
    def rel_mse_deviation(self):
        """Standard deviation of the reference's own contribution to rel_mse, whose expectation rel_mse() subtracts. It is the
        same for all images. Errors of pixels are assumed independent, those of a pixel's channels fully correlated."""
        pixels = (self.weights * self.variance).sum(axis=2)
        return float(np.sqrt(2 * (1 + 1 / self.freedom) * (pixels**2).sum()) / self.mean.size)


def read_rgb(path):
    """The image in an EXR file: array [row, column, channel]."""
    return Exr(path).rgb()


def averaged(image, scale):
    """The image with blocks of scale x scale pixels averaged. What is left at its edges is dropped."""
    height, width = image.shape[0] // scale, image.shape[1] // scale
    return image[: height * scale, : width * scale].reshape(height, scale, width, scale, -1).mean(axis=(1, 3))


def read_reference(path):
    try:
        file = Exr(path)
        mean, attributes = file.rgb(), file.attributes
        variance = file.rgb("variance.") if "variance.R" in file.channels else np.zeros_like(mean)
    except (OSError, KeyError, ValueError) as error:
        raise UserError(f"{path}: cannot be read as a reference: {error}") from None
    for key in ("scene", "scene_hash", "max_path_length"):
        if key not in attributes:
            raise UserError(f"{path}: has no attribute {key}: make the reference with ./lab reference SCENE")
    height, width = mean.shape[:2]
    stated = attributes.get("width", str(width)), attributes.get("height", str(height))
    if stated != (str(width), str(height)):
        raise UserError(f"{path}: has {width} x {height} pixels, but says {' x '.join(stated)}: render it again")
    return Reference(mean, variance, attributes)


def rel_mse(image, reference):
    """Mean of the weighted (x - r)^2, minus the variance of the reference."""
    return max(float((reference.weights * ((image - reference.mean) ** 2 - reference.variance)).mean()), 0.0)


def find_references(words):
    """Pairs (scene file, reference file) for scenes given by name or file, or for names of references; without words, all shipped
    ones. If a scene has several references, the one with the longest paths counts."""
    paths = [path for folder in FOLDERS for path in sorted(folder.glob("*.exr"))]
    if not words:
        shipped = [path for path in paths if path.parent == FOLDERS[0]]
        words = sorted({Path(read_attributes(path)["scene"]).stem for path in shipped})
    return [find_reference(word, paths) for word in words]


def find_reference(word, paths):
    is_file = Path(word).suffix in (".json", ".obj")
    if is_file and not Path(word).exists():
        raise UserError(f"{word}: no such file")
    found = [path for path in paths if path.stem == Path(word).stem]
    if not found:
        found = [path for path in paths if Path(read_attributes(path).get("scene", "")).stem == Path(word).stem]
    if not found and not scene_file(word).exists():
        names = ", ".join(sorted(path.stem for path in (ROOT / "assets/scenes").glob("*.json")))
        raise UserError(f"{word}: no such scene: name a .json or .obj file, or one of {names}")
    if not found:
        raise UserError(f"{word}: has no reference yet: ./lab reference {scene_file(word)} makes one")
    best = max(found, key=lambda path: int(read_attributes(path).get("max_path_length", 0)))
    scene = Path(word).resolve() if is_file else scene_file(Path(read_attributes(best).get("scene", word)).stem)
    return scene, best


def scene_file(word):
    """The scene file that a chapter uses for this word."""
    shipped = ROOT / "assets/scenes" / f"{word}.json"
    return shipped if shipped.exists() else Path(word)
