"""python3 tools diagrams: the drawings of the pages, docs/diagrams/NAME.svg."""
from pathlib import Path

from docs import light_diagrams as light
from docs import machine_diagrams as machine
from project import ROOT, Parser

DIAGRAMS = {diagram.__name__: diagram for diagram in (
    light.hemisphere, light.cosine_projection, light.path, light.light_patch, light.splitting_tree, light.roulette_tree, light.refraction,
    light.mis_weights, machine.alias_table, machine.shader_binding_table, machine.frame, machine.warp_lanes)}


def main():
    parser = Parser("python3 tools diagrams", __doc__)
    parser.add_argument("--output", type=Path, default=ROOT / "docs/diagrams", metavar="FOLDER", help="default: docs/diagrams")
    folder = parser.parse_args().output
    folder.mkdir(parents=True, exist_ok=True)
    for name, make in DIAGRAMS.items():
        (folder / f"{name}.svg").write_text(make().svg(), encoding="utf-8")
