"""Builds the wheel: maturin's part, and the two command-line programs that come with it."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import maturin
from maturin import (  # noqa: F401
    get_requires_for_build_editable,
    get_requires_for_build_sdist,
    get_requires_for_build_wheel,
)

HERE = Path(__file__).resolve().parent
PROGRAMS = ["amontons", "amontons-stability"]


def build_programs():
    """Builds the command-line programs and puts them where maturin looks for the scripts of a wheel."""
    command = ["cargo", "build", "--release", "--locked", "--package", "amontons-cli", "--bins"]
    messages = subprocess.run(
        [*command, "--message-format", "json-render-diagnostics"],
        cwd=HERE.parent.parent,
        stdout=subprocess.PIPE,
        check=True,
    ).stdout
    artifacts = [json.loads(line) for line in messages.splitlines()]
    folder = HERE / "programs" / "scripts"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for artifact in artifacts:
        if artifact.get("executable") and artifact["target"]["name"] in PROGRAMS:
            shutil.copy2(artifact["executable"], folder)
    missing = set(PROGRAMS) - {path.stem for path in folder.iterdir()}
    if missing:
        sys.exit(f"cargo has not built {', '.join(sorted(missing))}")


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    build_programs()
    return maturin.build_wheel(wheel_directory, config_settings, metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    build_programs()
    return maturin.build_editable(wheel_directory, config_settings, metadata_directory)


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit("the sources of this module are the whole repository: build it from a clone")


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    (HERE / "programs" / "scripts").mkdir(parents=True, exist_ok=True)
    return maturin.prepare_metadata_for_build_wheel(metadata_directory, config_settings)


prepare_metadata_for_build_editable = prepare_metadata_for_build_wheel
