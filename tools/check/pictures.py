"""Pictures of a check: what a shader rendered, and where that differs from the reference."""
import matplotlib

matplotlib.use("agg")
import numpy as np
from matplotlib import pyplot
from report.plots import encode_srgb, save_figure


def draw(result, pictures, path):
    """For each scene its mean picture, and below it each tile's difference from the reference; certain ones are framed. Returns
    the path of the file."""
    scenes = result["scenes"]
    figure, axes = pyplot.subplots(2, len(scenes), figsize=(3.6 * len(scenes), 7), layout="constrained", squeeze=False)
    limit = min(1, max(abs(tile["value"]) for scene in scenes for tile in scene["tiles"]))
    for top, axis, scene, picture in zip(*axes, scenes, pictures):
        top.imshow(encode_srgb(np.nan_to_num(picture)))
        top.set_title(f"{scene['scene']}: {scene['verdict']}", fontsize=10)
        rows, columns = (max(tile[key] for tile in scene["tiles"]) + 1 for key in ("row", "column"))
        values = np.array([100 * tile["value"] for tile in scene["tiles"]]).reshape(rows, columns)
        image = axis.imshow(values, cmap="RdBu_r", vmin=-100 * limit, vmax=100 * limit)
        for tile in (tile for tile in scene["tiles"] if tile["is_biased"]):
            axis.add_patch(pyplot.Rectangle((tile["column"] - 0.46, tile["row"] - 0.46), 0.92, 0.92, fill=False, lw=1.2))
        top.set_axis_off()
        axis.set_axis_off()
    figure.colorbar(image, ax=axes[1], label="difference of a tile from the reference, %", shrink=0.8, extend="both")
    save_figure(figure, path, dpi=80)
    return path
