"""Installs another renderer into a folder of its own, output/peers/NAME, in the version that was measured.

    ./lab notebook install_peer cycles
    ./lab notebook install_peer luxcore
    ./lab notebook install_peer mitsuba && . output/peers/mitsuba/bin/activate
"""
import shutil

from peers.renderers import FOLDER, PACKAGES, PYTHON
from project import Parser, UserError, run_to_end


def main():
    parser = Parser("./lab notebook install_peer", __doc__)
    parser.add_argument("renderer", choices=list(PACKAGES))
    renderer = parser.parse_args().renderer
    if not shutil.which(PYTHON):
        raise UserError(
            f"{PYTHON} is missing, for which these packages are made: install it, or `uv python install {PYTHON[6:]}`"
        )
    folder, packages = FOLDER / renderer, PACKAGES[renderer]
    run_to_end([PYTHON, "-m", "venv", "--clear", folder], f"a virtual environment in {folder}")
    print(f"installing {', '.join(packages)} into {folder}", flush=True)
    run_to_end([folder / "bin/python", "-m", "pip", "install", "--quiet", *packages], f"pip install {' '.join(packages)}")
