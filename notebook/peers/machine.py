"""What this machine renders on."""
import os
import platform
from pathlib import Path

from project import ROOT
from report.measurement import new_case, run_case


def processor():
    """Model of this machine's CPU, and the number of cores that programs may use."""
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines() if Path("/proc/cpuinfo").exists() else []
    models = [line.partition(": ")[2] for line in lines if line.startswith("model name")]
    return (models or [platform.machine()])[0], len(os.sched_getaffinity(0)) if hasattr(
        os, "sched_getaffinity"
    ) else os.cpu_count()


def find_device(program, settings):
    """The name of the device that these settings select."""
    tiny = new_case(ROOT / "assets/scenes/cornell_box.json", None, "which device?", program) | {"width": 8, "height": 8}
    return run_case(tiny, settings, ["--samples", 1])["device"]
