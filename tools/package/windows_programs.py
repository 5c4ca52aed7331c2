"""Builds the programs for Windows, on Debian or Ubuntu; before that, once, the libraries that have no package for Windows."""
import re
import shutil
import sys
from pathlib import Path

from project import CHAPTERS, ROOT, UserError, run_to_end

HERE = Path(__file__).parent / "windows"
BUILD = ROOT / "build/windows"  # may be deleted at any time
SOURCES, LIBRARIES = BUILD / "sources", BUILD / "libraries"
PROGRAMS = BUILD / "programs/bin"
COMPILER = "x86_64-w64-mingw32-g++-posix"
OTHERS = ["merge_images", "sample_points"]  # of a package, in addition to the chapters
# Built from source in the same version as for the Linux programs, so that both behave alike.
PACKAGES = ["glslang-dev", "libglfw3-dev", "libimgui-dev", "libimath-dev", "libopenexr-dev"]


def fetch_sources():
    """Unpacks the sources into SOURCES/NAME-VERSION. Uses private package lists, so it needs no root and leaves apt's alone."""
    versions = run_to_end(
        ["dpkg-query", "-W", "-f", "${source:Package}=${source:Version} ", *PACKAGES], "Asking for versions"
    ).split()
    stamp = SOURCES / "versions.txt"
    if stamp.exists() and stamp.read_text(encoding="utf-8").split() == versions:
        return
    shutil.rmtree(SOURCES, ignore_errors=True)
    for folder in ("apt/parts", "apt/lists/partial", "apt/cache/archives/partial"):
        (SOURCES / folder).mkdir(parents=True)
    for file in [Path("/etc/apt/sources.list"), *Path("/etc/apt/sources.list.d").glob("*")]:
        if file.suffix in (".list", ".sources") and file.exists():
            text = re.sub(
                r"(?m)^(deb |Types:.*)",
                lambda kind: "deb-src " if kind[0] == "deb " else "Types: deb-src",
                file.read_text(encoding="utf-8"),
            )
            (SOURCES / "apt/parts" / file.name).write_text(text, encoding="utf-8")
    apt = SOURCES / "apt"
    command = [
        "apt-get",
        "-o",
        "Dir::Etc::SourceList=/dev/null",
        "-o",
        f"Dir::Etc::SourceParts={apt}/parts",
        "-o",
        f"Dir::State::Lists={apt}/lists",
        "-o",
        f"Dir::Cache={apt}/cache",
        "-o",
        "APT::Sandbox::User=",
    ]
    run_to_end([*command, "update"], "Fetching the lists of sources")
    run_to_end([*command, "source", "--download-only", *versions], "Fetching sources", cwd=SOURCES)
    for description in SOURCES.glob("*.dsc"):
        if description.name.startswith("glslang"):  # Debian's patches link an optimiser that the lab does not use
            run_to_end(["tar", "-xf", next(SOURCES.glob("glslang_*.orig.tar.*"))], "Unpacking glslang", cwd=SOURCES)
        else:
            run_to_end(["dpkg-source", "-x", description], f"Unpacking {description.name}", cwd=SOURCES)
    stamp.write_text(" ".join(versions), encoding="utf-8")


def cmake(source, build, what, targets, **variables):
    """Configures and builds; takes a second if the folder is up to date."""
    variables |= {"CMAKE_BUILD_TYPE": "Release", "CMAKE_CXX_FLAGS_RELEASE": "-O2", "LAB_WINDOWS_LIBRARIES": LIBRARIES}
    run_to_end(
        [
            "cmake",
            "-G",
            "Ninja",
            "-S",
            source,
            "-B",
            build,
            "--toolchain",
            HERE / "toolchain.cmake",
            *(f"-D{name}={value}" for name, value in variables.items()),
        ],
        f"Configuring {what}",
    )
    print(f"Building {what} ...", file=sys.stderr, flush=True)
    run_to_end(["cmake", "--build", build, "--target", *targets], f"Building {what}")


def build(targets):
    """The programs with these names, in PROGRAMS."""
    if not shutil.which(COMPILER):
        raise UserError("there is no compiler for Windows: ./lab package windows installs it")
    fetch_sources()
    cmake(
        HERE,
        BUILD / "libraries_build",
        "the libraries for Windows (minutes, once)",
        ["install"],
        LAB_SOURCES=SOURCES,
        CMAKE_INSTALL_PREFIX=LIBRARIES,
    )
    cmake(ROOT, BUILD / "programs", "the programs for Windows", targets, LAB_TESTS="ON")


def main():
    """For the tests: python3 tools windows [TARGET ...]"""
    build(sys.argv[1:] or [*CHAPTERS.values(), *OTHERS])
    print(PROGRAMS)
