"""Where things lie, and what else a release is made with."""

import contextlib
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TARGET = Path(os.environ.get("CARGO_TARGET_DIR") or ROOT / "target").absolute()
CARGO_HOME = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
PACKAGES = TARGET / "release-packages"
VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]

# Debian's, with the standard library's sources: rustup has that library compiled for Windows, but a release is
# to be had from Debian's and Python's package indexes and crates.io alone.
DEBIAN_RUSTC = Path("/usr/bin/rustc")
DEBIAN_SOURCES = Path("/usr/lib/rustlib/src/rust/library")
MINGW = "x86_64-w64-mingw32-"

NEEDS = """\
Needed: Python 3.11 with venv, Rust (cargo on the PATH), binutils, and for Windows Debian's packages rustc-web,
rust-web-src and gcc-mingw-w64-x86-64-win32. cargo-zigbuild and ziglang are installed into target/release-tools."""


class Failed(Exception):
    """What went wrong, in words."""


def check():
    """Before the work: is there all that it takes?"""
    for program in ["cargo", "objdump", f"{MINGW}gcc", f"{MINGW}objdump"]:
        if not shutil.which(program):
            raise Failed(f"{program} is not on the PATH\n{NEEDS}")
    for path in [DEBIAN_RUSTC, DEBIAN_SOURCES]:
        if not path.exists():
            raise Failed(f"there is no {path}\n{NEEDS}")


def zigbuild():
    """cargo-zigbuild, in an environment of its own, and the PATH on which it finds zig."""
    environment = TARGET / "release-tools"
    folder = environment / "bin"
    wanted = Path(__file__).with_name("requirements.txt")
    stamp = environment / "made-of.txt"
    if not stamp.exists() or stamp.read_text() != wanted.read_text():
        shutil.rmtree(environment, ignore_errors=True)
        run([sys.executable, "-m", "venv", environment])
        run([folder / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", wanted])
        stamp.write_text(wanted.read_text())
    return folder / "cargo-zigbuild", f"{folder}{os.pathsep}{os.environ['PATH']}"


def run(command, stdout=None, **environment):
    """Runs a command in the repository, with these variables set (or, where None, not); what it prints goes to a file
    where one is named."""
    variables = {**os.environ, **environment}
    variables = {name: value for name, value in variables.items() if value is not None}
    with contextlib.nullcontext() if stdout is None else open(stdout, "w") as output:
        # Found on the PATH that it gets.
        program = shutil.which(command[0], path=variables["PATH"]) or command[0]
        status = subprocess.run([program, *command[1:]], cwd=ROOT, env=variables, stdout=output).returncode
    if status != 0:
        raise Failed(f"{' '.join(map(str, command))} ended with {status}")


def output(command):
    """What a command prints."""
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        raise Failed(f"{' '.join(map(str, command))} ended with {done.returncode}")
    return done.stdout


def date():
    """The time that all files of a release carry, s since 1970: SOURCE_DATE_EPOCH, or the commit's."""
    given = os.environ.get("SOURCE_DATE_EPOCH")
    return int(given or output(["git", "log", "-1", "--format=%ct"]))
