"""The libraries and the programs of a release."""

import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import checks
import tools

LIBRARIES = tools.TARGET / "release-libraries"
# One for each compiler, so that they work side by side.
BUILT = tools.TARGET / "release-build"
BUILT_BY_ZIG, BUILT_BY_DEBIAN = BUILT / "linux", BUILT / "windows"
LINUX = "x86_64-unknown-linux-gnu"
WINDOWS = "x86_64-pc-windows-gnu"
PROGRAMS = ["amontons", "amontons-stability"]
# An undefined symbol fails here, not in an importer.
DEFINED = "-Clink-arg=-Wl,-z,defs"
# No time of the build in the file.
TIMELESS = "-Clink-arg=-Wl,--no-insert-timestamp"


def flags(*more):
    """Messages of panics name source files; where this machine keeps them is not for a release to tell."""
    places = {tools.CARGO_HOME: "cargo", BUILT: "target", tools.ROOT: "amontons"}
    # Of Debian's standard library, whose folder is reached by a link.
    places |= {path: "std" for path in {tools.DEBIAN_SOURCES, tools.DEBIAN_SOURCES.resolve()}}
    # Of several that fit, the last is taken: the longest.
    ordered = sorted(places.items(), key=lambda place: len(str(place[0])))
    return "\x1f".join([f"--remap-path-prefix={path}={name}" for path, name in ordered] + list(more))


def common(built, *more):
    """What is the same in all builds. Settings of the caller's shell are not for a release."""
    settings = {name: None for name in os.environ if name.startswith("CARGO_PROFILE_")}
    return settings | {
        "CARGO_ENCODED_RUSTFLAGS": flags(*more),
        "CARGO_PROFILE_RELEASE_STRIP": "symbols",
        "AMONTONS_FMU_LIBRARIES": str(LIBRARIES),
        "CARGO_TARGET_DIR": str(built),
    }


def for_linux(command, *arguments, more=()):
    program, path = tools.zigbuild()
    target = ["--locked", "--target", f"{LINUX}.2.17"]
    tools.run([program, command, *target, *arguments], PATH=path, **common(BUILT_BY_ZIG, *more))


def for_windows(command, *arguments):
    # What cargo calls unstable is that the standard library is built along; the version is Debian's.
    debian = {"RUSTC": str(tools.DEBIAN_RUSTC), "RUSTC_BOOTSTRAP": "1"}
    target = ["--locked", "--target", WINDOWS, "-Z", "build-std=std,panic_unwind"]
    tools.run(["cargo", command, *target, *arguments], **debian, **common(BUILT_BY_DEBIAN, TIMELESS))


LIBRARY = ["--package", "amontons", "--lib", "--crate-type", "cdylib", "--profile", "fmu", "--no-default-features"]


def libraries():
    """Both at once: each ends with minutes on one core."""
    with ThreadPoolExecutor() as pool:
        for made in [pool.submit(linux_library), pool.submit(windows_library)]:
            made.result()


def linux_library():
    for_linux("rustc", *LIBRARY, more=[DEFINED])
    place(BUILT_BY_ZIG / LINUX / "fmu" / "libamontons.so", LIBRARIES / "linux64" / "amontons.so", checks.linux_library)


def windows_library():
    for_windows("rustc", *LIBRARY)
    place(BUILT_BY_DEBIAN / WINDOWS / "fmu" / "amontons.dll", LIBRARIES / "win64" / "amontons.dll", checks.windows)


def place(built, destination, check):
    check(built)
    destination.parent.mkdir(parents=True, exist_ok=True)
    # Where it is the same, programs that carry it are not built anew.
    if not destination.exists() or destination.read_bytes() != built.read_bytes():
        shutil.copyfile(built, destination)


MODULE = ["--package", "amontons-python", "--lib"]


def bins():
    return ["--package", "amontons-cli"] + [argument for name in PROGRAMS for argument in ("--bin", name)]


def linux_programs():
    for_linux("zigbuild", "--release", *bins())
    return checked([linux_program(name) for name in PROGRAMS], checks.linux)


def windows_programs():
    for_windows("build", "--release", *bins())
    return checked([windows_program(name) for name in PROGRAMS], checks.windows)


def linux_module():
    """The compiled part of the Python module."""
    for_linux("zigbuild", "--release", *MODULE)
    return checked([BUILT_BY_ZIG / LINUX / "release" / "lib_core.so"], checks.linux)[0]


def windows_module():
    for_windows("build", "--release", *MODULE)
    built = BUILT_BY_DEBIAN / WINDOWS / "release"
    # Python wants another ending.
    module = shutil.copyfile(built / "_core.dll", built / "_core.pyd")
    return checked([module], checks.windows)[0]


def linux_program(name=PROGRAMS[0]):
    return BUILT_BY_ZIG / LINUX / "release" / name


def windows_program(name=PROGRAMS[0]):
    return BUILT_BY_DEBIAN / WINDOWS / "release" / f"{name}.exe"


def checked(programs, check):
    for program in programs:
        check(program)
    return programs
