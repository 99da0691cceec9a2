"""Saved states: the run goes on from them with the same doubles, here and in another process."""

import subprocess
import sys

import pytest
from fmpy.fmi2 import fmi2Error, fmi2FMUstate, fmi2OK

KICK = {"initial.module[1].v2": 0.3, "module[2].k1": 56e3}
BEFORE = [1e-3 * i for i in range(1, 31)]
AFTER = [0.03 + 1e-3 * i for i in range(1, 31)]
# Every tunable parameter, both inputs that are not forces, and a force.
TUNED = {
    "friction.coefficient": 0.4,
    "slider.velocity": -0.1,
    "damping.beta": 1e-4,
    "module[1].preload": 7e-3,
    "module[1].f4": -30.0,
}


@pytest.fixture
def running(instance):
    """An instance that has squealed for 0.03 s."""

    def start(scene="set2", **arguments):
        one = instance(scene, **arguments).initialize(KICK)
        assert one.advance(BEFORE)["statistics.state_changes"][-1] > 5
        return one

    return start


def saved(one):
    status, state = one.GetFMUstate()
    assert status == fmi2OK
    assert state.value
    return state


def rewind(one, state):
    assert one.SetFMUstate(state) == fmi2OK, one.reason
    one.time = 0.03


def test_a_restored_instance_takes_the_same_doubles_again(running, assert_same):
    one = running()
    state = saved(one)
    first = one.advance(AFTER)
    for _ in range(2):
        rewind(one, state)
        assert_same(first, one.advance(AFTER))
    one.free_state(state)
    assert not state.value


def test_restoring_undoes_what_was_set_in_between(running, assert_same):
    """Read right away and after steps."""
    one = running()
    state = saved(one)
    first = one.advance(AFTER)
    for name, value in TUNED.items():
        rewind(one, state)
        assert one.Set({name: value}) == fmi2OK, one.reason
        other = one.advance(AFTER)
        assert other["module[1].x1"][-1] != first["module[1].x1"][-1], name
        rewind(one, state)
        assert_same(first, one.advance(AFTER))


def test_what_is_tuned_shows_at_once_and_goes_into_the_state(running, instance, assert_same):
    """Forces are those of the values as they are now, however the instance came by them."""
    one, fresh = running(), instance("set2", name="fresh")
    force = one.read(["contact[1].friction_force"])
    for name, value in TUNED.items():
        assert one.Set({name: value}) == fmi2OK, one.reason
        last, force = force, one.read(["contact[1].friction_force"])
        # The preload acts on the other mass: its motion has to reach the contact first.
        assert (force == last) == (name == "module[1].preload"), name
    rewind(fresh, saved(one))
    assert_same(one.advance(AFTER), fresh.advance(AFTER))


def test_a_state_goes_into_another_instance(running, instance, assert_same):
    one = running()
    state = saved(one)
    first = one.advance(AFTER)
    others = [instance("set2", name="fresh")]
    # Another structure, and another equilibrium of the same structure.
    for values in ({"module[1].m1": 0.4}, {**KICK, "module[2].preload": 6e-3}):
        others.append(instance("set2", name=str(values)).initialize(values))
        others[-1].advance(BEFORE[:7])
    for other in others:
        rewind(other, state)
        assert_same(first, other.advance(AFTER))


def test_a_state_from_before_the_start_brings_back_the_start_values(instance, assert_same):
    one = instance("set2")
    assert one.Set(KICK) == fmi2OK
    state = saved(one)
    first = one.initialize().advance(BEFORE)
    assert one.SetFMUstate(state) == fmi2OK
    assert_same(first, one.initialize().advance(BEFORE))


def test_getting_into_a_state_that_exists_replaces_it(running, assert_same):
    one = running()
    state = saved(one)
    handle = state.value
    one.advance(AFTER[:15])
    assert one.GetFMUstate(state) == (fmi2OK, state)
    assert state.value == handle
    rest = one.advance(AFTER[15:])
    assert one.SetFMUstate(state) == fmi2OK
    one.time = AFTER[14]
    assert_same(rest, one.advance(AFTER[15:]))


def test_a_serialized_state_is_the_same_bytes_however_it_came_about(running):
    one, two = running(), running()
    content = one.serialize(saved(one))
    assert content == two.serialize(saved(two))
    status, state = two.DeSerializeFMUstate(content)
    assert status == fmi2OK
    assert two.serialize(state) == content


RESUME = """
import sys
from fmpy import read_model_description
from fmpy.fmi2 import FMU2Slave

folder, state, *times = sys.argv[1:]
description = read_model_description(folder)
slave = FMU2Slave(
    guid=description.guid,
    unzipDirectory=folder,
    modelIdentifier=description.coSimulation.modelIdentifier,
    instanceName="resumed",
)
slave.instantiate()
slave.setFMUstate(slave.deSerializeFMUstate(open(state, "rb").read()))
times = [float.fromhex(time) for time in times]
outputs = [v for v in description.modelVariables if v.causality == "output"]
for now, then in zip(times, [*times[1:], None]):
    row = []
    for v in outputs:
        get = slave.getReal if v.type == "Real" else slave.getInteger
        row.append(float(get([v.valueReference])[0]).hex())
    print(*row)
    if then is not None:
        slave.doStep(now, then - now)
"""


def test_another_process_resumes_with_the_same_doubles(running, differences, tmp_path):
    one = running()
    file = tmp_path / "state"
    file.write_bytes(one.serialize(saved(one)))
    expected = one.advance(AFTER)
    assert expected["statistics.state_changes"][-1] > expected["statistics.state_changes"][0]
    times = [float(time).hex() for time in expected.times]
    command = [sys.executable, "-c", RESUME, str(one.fmu.folder), str(file), *times]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = [[float.fromhex(value) for value in line.split()] for line in printed.splitlines()]
    columns = dict(zip(one.fmu.outputs, zip(*rows)))
    assert not differences(expected, expected._replace(columns=columns))


def test_every_flipped_bit_and_every_truncation_is_refused(running):
    one = running()
    content = one.serialize(saved(one))
    damaged = [content[:length] for length in range(len(content))]
    for bit in range(8 * len(content)):
        flipped = bytearray(content)
        flipped[bit // 8] ^= 1 << bit % 8
        damaged.append(bytes(flipped))
    damaged.append(content + b"\0")
    for bad in damaged:
        status, state = one.DeSerializeFMUstate(bad)
        assert status == fmi2Error and not state.value
    assert "damaged" in one.reason
    status, state = one.DeSerializeFMUstate(content)
    assert status == fmi2OK and one.SetFMUstate(state) == fmi2OK


def test_the_state_of_another_scene_is_refused(running, instance):
    one = running("set1")
    other = instance("set2").initialize()
    status, state = other.DeSerializeFMUstate(one.serialize(saved(one)))
    assert status == fmi2Error and not state.value
    assert "another FMU" in other.reason


def test_null_is_no_state(running):
    one = running()
    assert one.SetFMUstate(fmi2FMUstate()) == fmi2Error
    assert "NULL" in one.reason
    one.free_state(fmi2FMUstate())
