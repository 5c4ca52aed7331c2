"""Whether one point in four dimensions for pixel and lens pays, and the concentric map of the disc: errors of chapter 12 with both, with
a point of its own for pixel and lens, and with chapter 2's polar map.

    ./lab notebook lens_points [--runs 8] [--output FILE.json]

All take turns, with another seed in each run. The errors are those that the halves of the samples tell.
"""
import tempfile
import time
from pathlib import Path

from measure.turns import rendered
from project import ROOT, Parser, number, show_progress, write_json
from tables.sources import stamped

CHAPTER, SHADER = "12_lens", "camera.glsl"
JOINT = "get_joint_numbers(seed, on_aperture, in_pixel);"
PADDED = "on_aperture = get_random_numbers(seed); in_pixel = get_random_numbers(seed);"
DISC = "sample_disc(on_aperture);"
POLAR = "sqrt(on_aperture.x) * vec2(cos(2.0 * PI * on_aperture.y), sin(2.0 * PI * on_aperture.y));"
APERTURES, SAMPLES = (0.03, 0.1, 0.3), 1024


def measure(shader, aperture, seed, folder):
    """Mean squared error by samples, of one picture."""
    content = rendered(
        CHAPTER,
        "focus",
        folder,
        "--width=150",
        "--height=100",
        f"--samples={SAMPLES}",
        f"--seed={seed}",
        "--max-path-length=1",
        f"--aperture-diameter={aperture}",
        f"--shader={SHADER}={shader}",
    )
    return content["device"], {str(row["samples"]): row["mse"] for row in content["rows"] if row["samples"] >= 16}


def main():
    parser = Parser("./lab notebook lens_points", __doc__)
    parser.add_argument("--runs", type=number(int, 2), default=8, help="default: 8")
    parser.add_argument("--output", type=Path, default=ROOT / "notebook/records/lens/llvmpipe.json", metavar="FILE.json")
    options, rows, started = parser.parse_args(), [], time.monotonic()
    text = (ROOT / "chapters" / CHAPTER / SHADER).read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as name:
        folder, shaders = Path(name), {"joint": text, "padded": text.replace(JOINT, PADDED), "polar": text.replace(DISC, POLAR)}
        assert len(set(shaders.values())) == len(shaders)
        for way, content in shaders.items():
            (folder / f"{way}.glsl").write_text(content, encoding="utf-8")
        for aperture in APERTURES:
            errors = {way: [] for way in shaders}
            for run in range(options.runs):
                for way, runs in errors.items():
                    device, found = measure(folder / f"{way}.glsl", aperture, 1 + run, folder)
                    runs.append(found)
                show_progress("lens_points", len(rows) * options.runs + run + 1, len(APERTURES) * options.runs, started)
            rows.append({"aperture_diameter": aperture, **errors})
    write_json(options.output, stamped({"device": device, "scene": "focus", "max_path_length": 1, "rows": rows}))
