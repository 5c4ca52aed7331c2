#!/usr/bin/env python3
"""Renders docs/pictures: one a chapter for about the same number of rays, of the Cornell box or what it is about."""
import argparse
import sys

from measurement import CHAPTERS, new_case, run_case
from reference_image import ROOT

SIZE = {"width": 320, "height": 320}
RAYS_PER_PIXEL = 400


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--backend", default="compute", help="default: compute")
    settings = {"backend": parser.parse_args().backend, "device": None}
    for chapter in CHAPTERS:
        scene = "glass" if chapter == "06_dielectrics" else "cornell_box"
        case = new_case(ROOT / f"assets/scenes/{scene}.json", None, chapter, chapter) | SIZE
        pilot = run_case(case, settings, ["--samples", 1])["rows"][-1]
        samples = max(1, round(RAYS_PER_PIXEL * SIZE["width"] * SIZE["height"] / pilot["rays"]))
        picture = ROOT / f"docs/pictures/{chapter}.png"
        print(f"{picture.relative_to(ROOT)}: {samples} samples", file=sys.stderr)
        run_case(case, settings, ["--samples", samples, "--output", picture])


if __name__ == "__main__":
    main()
