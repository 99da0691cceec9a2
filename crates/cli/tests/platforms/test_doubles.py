"""The libraries of a release, natively and, through wine, on Windows: the doubles of `amontons simulate`.

AMONTONS is a program that carries both, AMONTONS_FOLDER a folder to work in, AMONTONS_HOST a Windows program made
of host.c.
"""

import os
import signal
import struct
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from urllib.parse import quote

import fmpy
import pytest

AMONTONS = os.environ["AMONTONS"]
FOLDER = Path(os.environ["AMONTONS_FOLDER"])
HOST = os.environ["AMONTONS_HOST"]
ROWS = 200
TRIES = 5
# Enough for contacts to stick and to slip.
KICK = {"initial.module[1].v2": 0.3}
# Interval, s, and start values, of a scene for each kind of thing that a platform's own library could compute: the
# sine and cosine of directions, eigenvalues, e^x.
SCENES = {
    "set1": (5e-4, KICK),
    "scenes/effects/stability.toml": (0.05, {}),
    "scenes/effects/stribeck.toml": (0.005, {}),
}


def run(*command, **more):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=120, **more)
    return done.returncode, done.stdout, done.stderr


def succeed(*command):
    code, printed, errors = run(*command)
    assert code == 0, (command, errors)
    return printed


def expected(scene, interval, rows, values):
    """Names, and a row of doubles for each time."""
    settings = [f"--set={name}={value!r}" for name, value in values.items()]
    times = ["--stop-time", interval * rows, "--output-interval", interval]
    names, *table = (line.split(",") for line in succeed(AMONTONS, "simulate", scene, *times, *settings).splitlines())
    assert len(table) == rows + 1
    table = [[float(value) for value in row[1:]] for row in table]
    assert any(column[0] != column[-1] for column in zip(*table)), "nothing moves"
    return names[1:], table


def bits(table):
    """−0 is not 0, and the same NaN is the same."""
    return [[struct.pack("<d", value).hex() for value in row] for row in table]


def exported(scene, platform):
    """An FMU for one platform, unpacked, and its description."""
    file = FOLDER / f"{Path(scene).stem}-{platform}.fmu"
    succeed(AMONTONS, "export", scene, "--platform", platform, "-o", file)
    folders = {name.split("/")[1] for name in zipfile.ZipFile(file).namelist() if name.startswith("binaries/")}
    assert folders == {platform}
    folder = FOLDER / "unpacked here, größer µ" / file.stem
    fmpy.extract(str(file), folder)
    return file, folder, fmpy.read_model_description(str(file))


def windows(folder, about, resources, interval, rows, values=(), names=()):
    """Runs the library on Windows; exit code, a row of doubles for each time, messages."""
    variables = {variable.name: variable for variable in about.modelVariables}
    start = [f"={variables[name].valueReference}:{value!r}" for name, value in dict(values).items()]
    read = [("r" if variables[n].type == "Real" else "i") + str(variables[n].valueReference) for n in names]
    library = "binaries/win64/" + about.coSimulation.modelIdentifier + ".dll"
    command = ["wine64", HOST, library, about.guid, resources, interval, rows, *start, *read]
    code, printed, errors = run(*command, cwd=folder)
    table = [
        [struct.unpack(">d", bytes.fromhex(v))[0] if r[0] == "r" else float(v) for v, r in zip(line.split(), read)]
        for line in printed.splitlines()
    ]
    return code, table, errors


@pytest.mark.parametrize("scene", SCENES)
def test_windows_gets_the_doubles_of_the_program(scene):
    interval, values = SCENES[scene]
    names, right = expected(scene, interval, ROWS, values)
    _, folder, about = exported(scene, "win64")
    code, found, errors = windows(folder, about, "", interval, ROWS, values, names)
    assert code == 0, errors
    assert bits(found) == bits(right)
    # Another run is another.
    name = next(name for name in names if name.endswith(("x1", ".x")))
    column = names.index(name)
    assert len({row[column] for row in bits(right)}) > ROWS // 2


@pytest.mark.parametrize("scene", SCENES)
def test_linux_gets_the_doubles_of_the_program(scene):
    interval, values = SCENES[scene]
    names, right = expected(scene, interval, ROWS, values)
    file, _, _ = exported(scene, "linux64")
    settings = {"stop_time": interval * ROWS, "output_interval": interval, "start_values": values}
    result = fmpy.simulate_fmu(str(file), **settings)
    found = [[float(row[name]) for name in names] for row in result]
    assert bits(found) == bits(right)


SPELLINGS = {
    "NULL": lambda path: "",
    "a drive": lambda path: "file:///Z:" + quote(path),
    "a drive, encoded": lambda path: "file:///Z%3A" + quote(path),
    "a drive after one slash": lambda path: "file:/Z:" + quote(path),
    "a drive as the host": lambda path: "file://Z:" + quote(path),
    "backslashes": lambda path: "Z:" + path.replace("/", "\\"),
    "on the present drive": lambda path: "file://" + quote(path),
}


@pytest.mark.parametrize("spelling", SPELLINGS)
def test_windows_finds_the_resources(spelling):
    _, folder, about = exported("set1", "win64")
    resources = SPELLINGS[spelling](str(folder / "resources"))
    # wine's command line is in the system's code page; only what is encoded keeps its letters there.
    if spelling == "backslashes":
        plain = FOLDER / "plain"
        if not plain.exists():
            plain.symlink_to(folder)
        resources = SPELLINGS[spelling](str(plain / "resources"))
    code, _, errors = windows(folder, about, resources, 1e-3, 1)
    assert code == 0, errors


@pytest.mark.parametrize("resources", ["http://host/x", "relative", "file:///Z:/nowhere", "file:///Z:/%2"])
def test_windows_says_why_it_refuses(resources):
    _, folder, about = exported("set1", "win64")
    code, _, errors = windows(folder, about, resources, 1e-3, 1)
    # By way of the variadic logger.
    assert code == 3 and "logStatusError" in errors, errors


def test_fmpy_simulates_windows_through_wine():
    """Few rows, and some tries: FMPy's server for other platforms now and then waits for ever under wine 8, more often
    the more calls there are, and with a wineserver that has run one before. The host above does not. Each row has all
    steps before it in its last bits."""
    interval, rows = 5e-3, 10
    names, right = expected("set1", interval, rows, KICK)
    file, _, _ = exported("set1", "win64")
    settings = {"stop_time": interval * rows, "output_interval": interval, "start_values": KICK}
    code = (
        f"import fmpy\nresult = fmpy.simulate_fmu({str(file)!r}, **{settings!r})\n"
        f"for row in result: print('row', *(float(row[name]).hex() for name in {names!r}))\n"
    )
    for _ in range(TRIES):
        printed = simulated_within(60, code)
        if printed is not None:
            break
    assert printed is not None, f"FMPy did not end, {TRIES} times"
    lines = [line.split()[1:] for line in printed.splitlines() if line.startswith("row ")]
    assert bits([[float.fromhex(value) for value in line] for line in lines]) == bits(right)


def simulated_within(seconds, code):
    """What Python code prints; None where it does not end in time."""
    subprocess.run(["wineserver64", "-k"], stderr=subprocess.DEVNULL)
    # To a file: the server would keep a pipe open.
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(
            [sys.executable, "-c", code], stdout=output, stderr=subprocess.STDOUT, start_new_session=True
        )
        try:
            status = process.wait(seconds)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return None
        output.seek(0)
        printed = output.read().decode()
    assert status == 0, printed
    return printed
