"""Renders the pictures that show the chapters at equal time into docs/pictures: how many samples that is, the records say.

./lab figures makes the others.
"""
from pathlib import Path

from docs import figures
from docs.figure_plots import bytes_of, sheet_of
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont
from project import Parser
from report.plots import LABEL
from tables.cells import per_sample
from tables.chapter_tables import kind_of
from tables.records import load_records

GOES_ON = True
SECONDS = 2  # for each render


def renders_at_equal_time(scenes=("cornell_box", "heart_light"), size=160):
    """As many samples as fit into SECONDS according to the first record of the chapters, whatever the current load."""
    renders = []
    for case in load_records("chapters")[0]["cases"]:
        if kind_of(case) == "chapter" and case["scene"].startswith(scenes):
            scene = Path(case["scene_file"]).stem
            options = (
                "--samples",
                round(SECONDS / (per_sample(case, "device_seconds") * size**2)),
                "--max-path-length",
                case["max_path_length"],
            )
            renders.append(
                figures.Render(
                    f"{scene}_{int(case['program'][:2])}",
                    case["program"],
                    scene,
                    size,
                    options,
                    row=scenes.index(scene),
                    label="chapter {number}: {samples:,} samples",
                )
            )
    return renders


def noise(folder, renders):
    """The chapters at equal time: an animation with a second and a half for each."""
    frames = []
    for render in renders:
        height, width, _ = render.image.shape
        frame = Image.new("RGB", (2 * width, 2 * height + 2 * LABEL), "white")
        frame.paste(Image.fromarray(bytes_of(render.image)).resize((2 * width, 2 * height), Image.NEAREST), (0, 2 * LABEL))
        font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 22)
        title = f"chapter {int(render.chapter[:2])}: {render.chapter[3:].replace('_', ' ')}"
        ImageDraw.Draw(frame).text((LABEL // 2, LABEL // 2), title, "black", font)
        frames.append(frame)
    frames[0].save(folder / "noise.webp", save_all=True, append_images=frames[1:], duration=1500, loop=0, quality=80)


FIGURES = {
    "noise": (lambda: renders_at_equal_time(("cornell_box",), 256), noise),
    "equal_time": (renders_at_equal_time, sheet_of("equal_time")),
}


def main():
    parser = Parser("./lab notebook figures", __doc__)
    parser.parse_args()
    figures.FIGURES |= FIGURES
    figures.make(list(FIGURES), figures.PICTURES)
