"""A scene that says itself what is an input and what a parameter, and goes without the rest."""

import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from lxml import etree

INTERVAL = 2e-4

INPUTS = """
[inputs]
slider_velocity = "parameter"
friction = "parameter"
preload = "input"
forces = "none"
"""

PRELOADS = """time,module[1].preload,module[2].preload
0,0.005,0.006
0.00313,0.001,0.006
0.0082,0.004,0.0002
0.0082,0.006,0.0002
0.031,0.005,0.005
"""

VALUES = {"slider.velocity": 0.05, "friction.coefficient": 1.5, "initial.module[1].v2": 0.3}


@pytest.fixture
def turned(amontons, fmu_in, tmp_path):
    """Set 1 without links and with roles turned round: the scene file, its FMU, packed and unpacked."""
    shown = amontons("scenes", "show", "set1")
    lines = [line for line in shown.splitlines() if not line.startswith(("k1 ", "k2 "))]
    scene = tmp_path / "turned.toml"
    scene.write_text("\n".join(lines) + INPUTS)
    fmu = tmp_path / "turned.fmu"
    amontons("export", scene, "-o", fmu)
    folder = tmp_path / "unpacked"
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    return scene, fmu, fmu_in(folder)


@pytest.fixture
def preloads(tmp_path):
    """A table of both preloads over time."""
    table = tmp_path / "preloads.csv"
    table.write_text(PRELOADS)
    return table


def test_fmpy_finds_no_problems_with_it(turned):
    _, packed, fmu = turned
    command = [sys.executable, "-m", "fmpy", "validate", str(packed)]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert printed.strip() == "No problems found."
    schema = Path(fmpy.__file__).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
    description = etree.parse(str(fmu.folder / "modelDescription.xml"))
    etree.XMLSchema(file=str(schema)).assertValid(description)


def test_its_variables_have_the_roles_that_the_scene_gives_them(turned):
    *_, fmu = turned
    roles = {name: (v.causality, v.variability) for name, v in fmu.variables.items()}
    for name in ("slider.velocity", "friction.coefficient"):
        assert roles[name] == ("parameter", "tunable")
    inputs = [name for name, (causality, _) in roles.items() if causality == "input"]
    assert inputs == ["module[1].preload", "module[2].preload"]
    assert {roles[name][1] for name in inputs} == {"continuous"}
    for name in ("module[1].f1", "module[1].k1", "module[2].k2", "damping.alpha"):
        assert name not in roles


def test_fmpy_gets_the_doubles_of_the_program(
    turned, preloads, imported, native, differences, assert_same
):
    scene, _, fmu = turned
    expected = native(scene, 0.04, INTERVAL, VALUES, inputs=preloads)
    assert expected["statistics.state_changes"][-1] > 3
    assert differences(expected, native(scene, 0.04, INTERVAL, VALUES)), "the inputs do nothing"
    assert_same(expected, imported(fmu, 0.04, INTERVAL, VALUES, inputs=preloads))


def test_a_parameter_set_between_steps_takes_effect_from_then_on(turned, instance, differences):
    *_, fmu = turned
    grid = [i * INTERVAL for i in range(1, 101)]
    values = {"initial.module[1].v2": 0.3}
    plain, tuned = (instance(fmu).initialize(values) for _ in range(2))
    assert not differences(plain.advance(grid[:50]), tuned.advance(grid[:50]))
    assert tuned.Set({"friction.coefficient": 0.3, "slider.velocity": -0.2}) == 0
    assert tuned.read(["friction.coefficient", "slider.velocity"]) == [0.3, -0.2]
    assert differences(plain.advance(grid[50:]), tuned.advance(grid[50:]))
