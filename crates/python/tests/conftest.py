"""What several tests use."""

import json
import os
import subprocess
import sys
from pathlib import Path

import amontons
import pytest


@pytest.fixture(scope="session")
def set1():
    return amontons.Scene.builtin("set1")


@pytest.fixture(scope="session")
def held():
    """A block that rests on its belt until a push makes it stick and slip."""
    text = amontons.Scene.builtin("stick_slip").text
    return amontons.Scene.from_toml(f"{text}\n[damping]\nalpha = 0.3\n", "held")


@pytest.fixture(scope="session")
def programs():
    """The folder with the command-line programs, which AMONTONS_PROGRAMS names."""
    folder = os.environ.get("AMONTONS_PROGRAMS")
    if not folder:
        pytest.skip("AMONTONS_PROGRAMS names no folder with the programs amontons and amontons-stability")
    return Path(folder)


@pytest.fixture
def python(tmp_path):
    """Runs a text as a script of an interpreter of its own; gives what it prints."""

    def run(text, *before, timeout=60, code=0, environment=None):
        script = tmp_path / "script.py"
        script.write_text(text)
        module = str(Path(amontons.__file__).parent.parent)
        path = os.pathsep.join([module, str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")])
        command = [*before, sys.executable] if before else [sys.executable]
        result = subprocess.run(
            [*command, str(script)],
            capture_output=True,
            text=True,
            timeout=timeout,
            env={**os.environ, "PYTHONPATH": path, **(environment or {})},
        )
        assert result.returncode == code, f"exit {result.returncode}\n{result.stdout}\n{result.stderr}"
        return result.stdout

    return run


def bytes_of(table):
    """All names, types and bytes of a table; all numbers of a dictionary, to the last bit."""
    if isinstance(table, dict):
        return json.dumps(table)
    arrays = {name: table[name] for name in sorted([*table.data_vars, *table.coords])}
    parts = [(name, array.dims, array.dtype.str, array.values.tobytes()) for name, array in arrays.items()]
    return parts, repr(sorted(table.attrs.items()))
