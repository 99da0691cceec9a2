"""FMPy on the release's libraries, natively and, through wine, on Windows': the doubles of `amontons simulate`.

AMONTONS is the release's program and AMONTONS_FOLDER a folder to work in.
"""

import os
import subprocess
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest

AMONTONS = os.environ["AMONTONS"]
FOLDER = Path(os.environ["AMONTONS_FOLDER"])
ROWS = 100
# Enough for contacts to stick and to slip.
KICK = {"initial.module[1].v2": 0.3}
# End of the run, s, and start values, of a scene for each kind of thing that a platform's own library could compute:
# the sine and cosine of directions, eigenvalues, e^x.
SCENES = {
    "set1": (0.05, KICK),
    "scenes/effects/stability.toml": (8.0, {}),
    "scenes/effects/stribeck.toml": (0.5, {}),
}


def amontons(*arguments):
    return subprocess.run([AMONTONS, *map(str, arguments)], check=True, stdout=subprocess.PIPE, text=True).stdout


def expected(scene, stop_time, values):
    settings = [f"--set={name}={value!r}" for name, value in values.items()]
    times = ["--stop-time", stop_time, "--output-interval", stop_time / ROWS]
    names, *rows = (line.split(",") for line in amontons("simulate", scene, *times, *settings).splitlines())
    columns = np.array([[float(value) for value in row] for row in rows]).T
    return dict(zip(names, columns))


def differences(one, other):
    """Names of the columns that are not the same to the bit."""
    assert set(one) == set(other)
    # As bits: −0 is not 0, and the same NaN is the same.
    return [name for name in one if one[name].astype(float).tobytes() != other[name].astype(float).tobytes()]


def exported(scene, platform):
    file = FOLDER / f"{Path(scene).stem}-{platform}.fmu"
    amontons("export", scene, "--platform", platform, "-o", file)
    folders = {name.split("/")[1] for name in zipfile.ZipFile(file).namelist() if name.startswith("binaries/")}
    assert folders == {platform}
    return file


@pytest.mark.parametrize("platform", ["linux64", "win64"])
@pytest.mark.parametrize("scene", SCENES)
def test_fmpy_gets_the_doubles_of_the_program(scene, platform):
    stop_time, values = SCENES[scene]
    result = fmpy.simulate_fmu(
        str(exported(scene, platform)),
        stop_time=stop_time,
        output_interval=stop_time / ROWS,
        start_values=values,
    )
    found = {name: result[name] for name in result.dtype.names}
    right = expected(scene, stop_time, values)
    assert len(right["time"]) == ROWS + 1
    assert any(np.ptp(column) > 0.0 for name, column in right.items() if name != "time")
    assert differences(right, found) == []
    # The comparison would see another last bit.
    name = next(name for name, column in right.items() if name != "time" and np.ptp(column) > 0.0)
    wrong = right | {name: np.nextafter(right[name], np.inf)}
    assert differences(wrong, found) == [name]
