"""Renders one of our scenes with another renderer and reports error against samples and seconds as a chapter does.

Takes a chapter's command line, as far as `./lab notebook report` and `./lab notebook renderers` need it. Several numbers after
--samples make a picture each. Seconds are those of rendering alone; kernels are compiled before.
"""
from importlib import import_module
from pathlib import Path

from peers.renderers import SETTINGS, renderer_of
from project import VARIANTS, Parser, UserError, write_json


def load(renderer):
    """The renderer's module."""
    try:
        return import_module(f"peers.{renderer}_peer")
    except ImportError as error:
        raise UserError(f"{error}: ./lab notebook install_peer {renderer}") from None


def report(module, options):
    from peers.film import Film, growing_rows, separate_rows  # they need what load() has found
    from references.exr import rgb_channels, write_exr
    from references.images import read_reference
    from references.scenes import read_scene

    scene = read_scene(options.scene)
    renderer = module.Renderer(scene, options)
    film = Film(renderer, read_reference(options.reference) if options.reference else None, options.seed)
    rows = list(separate_rows(film, options.samples)) if len(options.samples or []) > 1 else growing_rows(film, options)
    if options.output and film.total:
        write_exr(options.output, rgb_channels(film.total.image), {})
    return {
        "scene_hash": scene.hash,
        "device": renderer.name,
        "backend": renderer.integrator,
        "rows": rows,
        "discarded_seconds": renderer.discarded_seconds,
        "note": renderer.note,
    }


def main():
    parser = Parser("./lab notebook peer", __doc__)
    parser.add_argument("scene", type=Path)
    variants = [*VARIANTS, *(name for name in SETTINGS if name != "mitsuba")]
    parser.add_argument("--variant", choices=variants, required=True, help="of Mitsuba, or another renderer")
    for name in ("width", "height", "max-path-length", "seed"):
        parser.add_argument(f"--{name}", type=int, required=True)
    samplers = "; ".join(f"of {name}: {', '.join(values)}" for name, values in SETTINGS.items())
    parser.add_argument("--sampler", help=f"{samplers}; default: the first")
    length = parser.add_mutually_exclusive_group(required=True)
    length.add_argument("--samples", type=int, nargs="+", help="a pixel, or as many more as the sampler needs")
    length.add_argument("--time-limit", type=float, help="stop after so many seconds of rendering")
    for name in ("reference", "output", "report"):
        parser.add_argument(f"--{name}", type=Path)
    options = parser.parse_args()
    renderer = renderer_of(options.variant)
    options.sampler = options.sampler or SETTINGS[renderer][0]
    if options.sampler not in SETTINGS[renderer]:
        raise UserError(f"{renderer} has no --sampler {options.sampler}: {', '.join(SETTINGS[renderer])}")

    def run():
        content = report(module, options)
        if options.report:
            write_json(options.report, content)

    module = load(renderer)
    if renderer == "mitsuba":
        from references.mitsuba_scene import run_mitsuba

        run_mitsuba(options.variant, run)
    else:
        run()
