"""Inputs over time, from an importer and from the scene's own signals: FMPy's results against
`amontons simulate`, equal to the last bit."""

import zipfile

import numpy as np
import pytest

INTERVAL = 2e-4
KICK = {"initial.module[1].v2": 0.3}

# Times between the communication points, a jump on one of them and two off them.
RING = """time,slider.velocity,friction.coefficient,module[1].f1,module[2].f4
0,0.025,1.96,0,0
0.00313,0.02,1.5,30,-10
0.0082,-0.03,1.5,-20,40
0.0082,0.05,2.1,-20,40
0.01234567,0.05,2.1,10,-50
0.01234567,0.05,0.4,10,-50
0.02771,0.01,0.4,0,0
0.02771,0.06,1.9,200,0
0.031,0.025,1.96,0,0
"""

CORNER = """time,slider.velocity,mass.shaft.fx,mass.shaft.fy
0.0,0.5,0.0,0.0
0.0123,-0.4,60.0,-10.0
0.0151,0.2,60.0,70.0
0.0151,0.7,-60.0,0.0
"""

BRAKE = """time,contact.upper_lining.velocity,contact.lower_lining.velocity,mass.disc.fy
0,0.05,-0.05,0
0.004,0.0,-0.0,900
0.009,-0.05,0.05,-900
"""


@pytest.mark.parametrize(
    ("scene", "table", "stop_time"),
    [("set1", RING, 0.04), ("ring12", RING, 0.04), ("corner", CORNER, 0.05), ("disc_brake", BRAKE, 0.01)],
)
def test_fmpy_gets_the_doubles_of_the_program_from_the_same_inputs(
    imported, native, differences, assert_same, tmp_path, scene, table, stop_time
):
    inputs = tmp_path / "inputs.csv"
    inputs.write_text(table)
    expected = native(scene, stop_time, INTERVAL, inputs=inputs)
    assert expected["statistics.state_changes"][-1] > 3
    assert differences(expected, native(scene, stop_time, INTERVAL)), "the inputs do nothing"
    assert_same(expected, imported(scene, stop_time, INTERVAL, inputs=inputs))


SIGNALS = """
[[signal]]
input = "slider.velocity"
ramp = { from = -0.025, to = 0.03, start = 0.003, end = 0.02 }
[[signal]]
input = "module[1].f2"
sine = { amplitude = 50.0, frequency = 290.0, phase = 0.5, start = 0.001 }
[[signal]]
input = "module[1].f2"
pulse = { value = 60.0, start = 0.0111, end = 0.0171 }
[[signal]]
input = "module[2].f4"
table = { file = "push und Stoß.csv", column = "force" }
[[signal]]
input = "friction.coefficient"
table = { points = [[0.01, 0.0], [0.012, -0.3], [0.02, 0.3]], between = "constant" }
"""


@pytest.fixture
def driven(amontons, fmu_in, tmp_path):
    """A scene file of Set 1 under signals, and its unpacked FMU."""
    shown = amontons("scenes", "show", "set1")
    scene = tmp_path / "driven.toml"
    scene.write_text(shown + SIGNALS)
    table = tmp_path / "push und Stoß.csv"
    table.write_text("time,other,force\n0,7,0\n0.007,7,-40\n0.013,7,25.5\n0.013,7,0\n")
    fmu = tmp_path / "driven.fmu"
    amontons("export", scene, "-o", fmu)
    # Nothing of the FMU may depend on the files it was made from.
    folder = tmp_path / "unpacked"
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder)
    assert (folder / "resources" / table.name).read_text() == table.read_text()
    return scene, fmu_in(folder)


def test_signals_of_the_scene_act_in_the_fmu(imported, native, differences, assert_same, driven):
    scene, fmu = driven
    expected = native(scene, 0.04, INTERVAL, KICK)
    assert expected["statistics.state_changes"][-1] > 4
    assert differences(expected, native("set1", 0.04, INTERVAL, KICK)), "the signals do nothing"
    assert_same(expected, imported(fmu, 0.04, INTERVAL, KICK))


def test_inputs_and_signals_are_added(imported, native, assert_same, driven, tmp_path):
    scene, fmu = driven
    inputs = tmp_path / "inputs.csv"
    inputs.write_text(RING)
    expected = native(scene, 0.04, INTERVAL, inputs=inputs)
    assert_same(expected, imported(fmu, 0.04, INTERVAL, inputs=inputs))

    # A pulse of a power of two in the scene, or as a step of the importer's: the sums are exact.
    plain = tmp_path / "plain.toml"
    text = scene.read_text()
    plain.write_text(text + '[[signal]]\ninput = "module[1].f1"\nconstant = { value = 32.0 }\n')
    constant = tmp_path / "constant.csv"
    constant.write_text("time,module[1].f1\n0,32\n")
    assert_same(native(plain, 0.04, INTERVAL), imported(fmu, 0.04, INTERVAL, inputs=constant))


def test_an_input_reads_as_the_importer_gave_it(instance, driven):
    _, fmu = driven
    running = instance(fmu).initialize({"module[1].f2": 3.0})
    running.advance([0.0002 * i for i in range(1, 80)])
    assert running.read(["module[1].f2", "slider.velocity"]) == [3.0, 0.025]


def test_saved_states_go_on_under_signals(instance, assert_same, driven):
    _, fmu = driven
    grid = [0.0002 * i for i in range(1, 100)]
    running = instance(fmu).initialize()
    running.advance(grid[:37])
    status, state = running.GetFMUstate()
    assert status == 0
    content = running.serialize(state)
    expected = running.advance(grid[37:])
    other = instance(fmu).initialize()
    status, restored = other.DeSerializeFMUstate(content)
    assert status == 0 and other.SetFMUstate(restored) == 0
    other.time = grid[36]
    assert_same(expected, other.advance(grid[37:]))
    running.free_state(state)
    other.free_state(restored)


def test_a_table_that_was_changed_is_another_fmu(instance, driven):
    """The GUID covers the tables."""
    _, fmu = driven
    table = next((fmu.folder / "resources").glob("*.csv"))
    table.write_text(table.read_text().replace("25.5", "25.6"))
    refused = instance(fmu)
    assert refused.component is None
    assert "GUID" in refused.reason


def test_rows_between_the_communication_points_are_met_on_the_way(native, tmp_path):
    """Without rubbing the response to a force is in closed form; the file samples it finely."""
    scene = tmp_path / "free.toml"
    scene.write_text(
        '[[mass]]\nname = "a"\nmass = 0.5\nlocked = ["y"]\n[[spring]]\nname = "k"\n'
        'between = ["a", "ground"]\ndirection = "x"\nstiffness = 200.0\n[integrator]\nstep = 1e-5\n'
    )
    inputs = tmp_path / "step.csv"
    # A step between two communication points acts from its own time on.
    inputs.write_text("time,mass.a.fx\n0,0\n0.10005,0\n0.10005,3\n")
    found = native(scene, 0.5, 1e-3, inputs=inputs)
    expected = 3 / 200 * (1 - np.cos(20 * np.maximum(found.times - 0.10005, 0)))
    assert np.abs(found["mass.a.x"] - expected).max() < 3 / 200 * 20 * 1e-5
