"""FMPy's results against `amontons simulate`: equal to the last bit."""

import re
import shutil

import numpy as np
import pytest
from conftest import EFFECTS, SCENES

KICK = {"initial.module[1].v2": 0.3}
CHANGED = {
    "friction.coefficient": 1.2,
    "slider.velocity": 0.07,
    "module[1].k2": 61.7e3,
    "initial.module[1].v1": -0.2,
}
INTERVAL = 2e-4


@pytest.mark.parametrize(
    ("scene", "stop_time", "values"),
    [
        ("set1", 0.1, {}),
        ("set1", 0.1, KICK),
        ("set1", 0.1, CHANGED),
        ("set2", 0.1, {}),
        ("set2", 0.1, CHANGED),
        ("ring12", 0.04, {}),
        ("ring12", 0.04, {"initial.module[7].v1": -0.5, "module[3].m2": 0.8}),
    ],
)
def test_fmpy_gets_the_doubles_of_the_program(
    imported, native, unpacked, assert_same, scene, stop_time, values
):
    expected = native(scene, stop_time, INTERVAL, values)
    assert list(expected.columns) == unpacked(scene).outputs
    assert len(expected.times) == round(stop_time / INTERVAL) + 1
    if values or scene == "set2":
        # More than uniform sliding: contacts change their states.
        assert expected["statistics.state_changes"][-1] > 3
    assert_same(expected, imported(scene, stop_time, INTERVAL, values))


@pytest.mark.parametrize("scene", SCENES)
def test_fmpy_gets_the_doubles_of_the_program_in_every_scene(
    imported, native, unpacked, assert_same, scene
):
    """From its own start, at 501 times of the run that the scene asks for where it is of a single effect, else of
    a tenth of it or of 1 s."""
    stop_time = float(unpacked(scene).description.defaultExperiment.stopTime)
    if scene not in EFFECTS:
        stop_time = min(0.1 * stop_time, 1.0)
    expected = native(scene, stop_time, stop_time / 500)
    assert list(expected.columns) == unpacked(scene).outputs
    assert len(expected.times) == 501
    # It moves, but for the drive, which waits for a reaction.
    moving = [name for name, column in expected.columns.items() if np.ptp(column) > 0.0]
    assert bool(moving) == (scene != "drive")
    assert_same(expected, imported(scene, stop_time, stop_time / 500))


def test_the_comparison_rejects_an_fmu_with_another_number(
    imported, native, unpacked, fmu_in, instance, differences, tmp_path
):
    """k2 of module 1 off by 1e-12 of itself: no plot shows it."""
    folder = tmp_path / "wrong"
    shutil.copytree(unpacked("set1").folder, folder)
    scene = folder / "resources" / "scene.toml"
    text, count = re.subn(r"(?m)^k2 = 60e3 ", "k2 = [60000.00000006, 60e3] ", scene.read_text())
    assert count == 1
    scene.write_text(text)

    # The FMU notices by itself, and says which GUID such a scene would have.
    refused = instance(fmu_in(folder))
    assert refused.component is None
    guid = refused.fmu.description.guid
    expected_guid = re.search(r"whose GUID is (\{[0-9a-f-]{36}\})", refused.reason).group(1)
    description = folder / "modelDescription.xml"
    text = description.read_text()
    assert text.count(guid) == 1
    description.write_text(text.replace(guid, expected_guid))

    wrong = imported(fmu_in(folder), 0.1, INTERVAL, KICK)
    right = native("set1", 0.1, INTERVAL, KICK)
    found = differences(right, wrong)
    assert any(line.startswith("module[1].x2 in ") for line in found), found
    x, y = right["module[1].x2"], wrong["module[1].x2"]
    assert np.abs(x - y).max() < 1e-6 * np.abs(x).max()


def test_the_comparison_sees_the_last_bit_and_the_sign_of_zero(native, differences):
    right = native("set1", 0.001, INTERVAL)
    assert not differences(right, right)
    column = right["module[2].v1"]
    for value in (np.nextafter(column[3], 1.0), -column[3]):
        wrong = column.copy()
        wrong[3] = value
        assert differences(right, right._replace(columns={**right.columns, "module[2].v1": wrong}))
    zero = right["module[2].x4"]
    assert zero[0] == 0.0
    assert differences(right, right._replace(columns={**right.columns, "module[2].x4": -zero}))
    assert differences(right, right.part(slice(1, None)))
    assert differences(right.part([]), right.part([]))


def test_an_importer_may_start_at_any_time(instance, assert_same):
    """The motion does not depend on the time at which it starts; steps of a power of two leave
    no rounding in the times."""
    step = 2.0**-20
    grid = [1024 * step * i for i in range(1, 51)]
    values = {**KICK, "integrator.step": step}
    early = instance("set2").initialize(values).advance(grid)
    late = instance("set2").initialize(values, start=64.0).advance([64.0 + t for t in grid])
    assert_same(early, late._replace(times=late.times - 64.0))
