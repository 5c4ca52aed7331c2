"""What the records of chapters and peers measure: the chapters with their studies, and the variants of Mitsuba."""
from peers.renderers import CPU_VARIANTS, SAMPLERS, python_of
from project import ROOT, VARIANTS, UserError, chapter_named, failure_text, run_program
from references.images import find_references
from report.measurement import new_case
from report.studies import measures

PEER = f"{python_of('mitsuba')} notebook peer --variant"  # programs start in the project's folder
CPU_SCENES = ["cornell_box", "heart_light", "clear_glass"]
CPU_BACKENDS = {
    "compute": {"backend": "compute"},
    "native, one by one": {"backend": "native", "variables": ["LAB_LANES=0"]},
    "native, lanes": {"backend": "native"},
}


def peer_cases(scenes, variants, samplers, is_large=False):
    """Cases of variants of Mitsuba for pairs (scene file, reference file); the fastest variant also uses these samplers."""
    peers = [(variant, SAMPLERS[0]) for variant in variants]
    peers += [(variants[-1], sampler) for sampler in samplers if sampler != SAMPLERS[0]]
    return [
        new_case(
            scene,
            reference,
            f"Mitsuba {VARIANTS[variant]}" + (f", {sampler}" if sampler != SAMPLERS[0] else ""),
            f"{PEER} {variant}",
            ("--sampler", sampler),
            is_peer=True,
            is_large=is_large,
        )
        for scene, reference in scenes
        for variant, sampler in peers
    ]


def working_variants():
    """The variants of Mitsuba that work here. Each is tried in a separate process, since some crash."""
    size = ["--width", "8", "--height", "8", "--max-path-length", "1", "--samples", "1", "--seed", "1"]
    tried = {
        variant: run_program([*f"{PEER} {variant}".split(), ROOT / "assets/scenes/cornell_box.json", *size])
        for variant in VARIANTS
    }
    works = [variant for variant in VARIANTS if tried[variant].returncode == 0]
    if not works:
        raise UserError(failure_text(tried["scalar_rgb"]))
    return works


def study_cases():
    """The cases of docs/results.md: all chapters on each reference, then the options varied by single chapters."""

    def case(place, name, folder, *options):
        reference = ROOT / f"assets/references/{place}.exr"
        scene = place.rstrip("_0123456789") if reference.is_file() else place
        return new_case(ROOT / f"assets/scenes/{scene}.json", reference if reference.is_file() else None, name, folder, options)

    found = measures()
    places = dict.fromkeys(place for measure in found.values() for place in measure.get("compared_on", []))
    cases = [
        case(place, f"chapter {int(folder[:2])}", folder)
        for place in places
        for folder, measure in found.items()
        if place in measure.get("compared_on", [])
    ]
    return cases + [
        case(place, name, folder, *options.split())
        for folder, measure in found.items()
        for study in measure.get("studies", [])
        for place in study["on"]
        for name, options in study["cases"].items()
    ]


def cpu_cases():
    """Our backends for CPUs and Mitsuba's variants, on a few scenes. The sampler is Mitsuba's best on most scenes."""
    folder, pairs = chapter_named("path_regeneration"), find_references(CPU_SCENES)
    ours = [new_case(scene, reference, name, folder) | how for scene, reference in pairs for name, how in CPU_BACKENDS.items()]
    return ours + peer_cases(pairs, CPU_VARIANTS, ["multijitter"])
