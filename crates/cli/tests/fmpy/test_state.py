"""Saved states: the run goes on from them with the same doubles, here and in another process."""

import random
import struct
import subprocess
import sys
import zlib
from ctypes import byref, c_size_t

import pytest
from fmpy.fmi2 import (
    fmi2Error,
    fmi2FMUstate,
    fmi2LastSuccessfulTime,
    fmi2OK,
    fmi2Real,
)

KICK = {"initial.module[1].v2": 0.3, "module[2].k1": 56e3}
BEFORE = [1e-3 * i for i in range(1, 31)]
AFTER = [0.03 + 1e-3 * i for i in range(1, 31)]
# Where the bytes have their version and what follows the GUID, and how many the checksum has at their end.
VERSION, CONTENT, CHECKSUM = 4, 4 + 1 + 38, 4
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
    expected = one.advance([0.03 + 1e-3 * i for i in range(1, 121)])
    changes = expected["statistics.state_changes"]
    # In the first half and in the second.
    assert changes[0] < changes[60] < changes[-1]
    times = [float(time).hex() for time in expected.times]
    command = [sys.executable, "-c", RESUME, str(one.fmu.folder), str(file), *times]
    printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = [[float.fromhex(value) for value in line.split()] for line in printed.splitlines()]
    columns = dict(zip(one.fmu.outputs, zip(*rows)))
    assert not differences(expected, expected._replace(columns=columns))


# ---- Damage ----


def damages(content):
    """Kinds of damage, each with its pieces; what is drawn is drawn alike each time."""
    size, draw = len(content), random.Random(5)

    def flipped(bits):
        changed = bytearray(content)
        for bit in bits:
            changed[bit // 8] ^= 1 << bit % 8
        return bytes(changed)

    def swapped(i, j):
        changed = bytearray(content)
        changed[i], changed[j] = changed[j], changed[i]
        return bytes(changed)

    def burst():
        """Up to 32 bits in a row, the first and the last of which are wrong."""
        length = draw.randint(2, 32)
        start = draw.randrange(8 * size - length)
        middle = [start + i for i in range(1, length - 1) if draw.random() < 0.5]
        return flipped([start, *middle, start + length - 1])

    pairs = [draw.sample(range(size), 2) for _ in range(2000)]
    return {
        "flipped bits": [flipped([bit]) for bit in range(8 * size)],
        "truncations": [content[:length] for length in range(size)],
        "longer": [content + bytes(more) for more in (1, 2, 4, 8, 1000)] + [content + content],
        "bursts": [burst() for _ in range(2000)],
        "swapped bytes": [swapped(i, j) for i, j in pairs if content[i] != content[j]],
    }


def test_damaged_bytes_are_refused_and_leave_the_motion_as_it_is(running, assert_same):
    one = running()
    state = saved(one)
    content = one.serialize(state)
    before = one.read(one.fmu.outputs)
    first = one.advance(AFTER)
    rewind(one, state)
    for kind, pieces in damages(content).items():
        for bad in pieces:
            status, other = one.DeSerializeFMUstate(bad)
            assert status == fmi2Error and not other.value, kind
        assert "damaged" in one.reason
        print(f"{len(pieces)} {kind} of {len(content)} bytes refused")
        # All that a refusal does is that the instance has to be led out of its error.
        assert one.read(one.fmu.outputs) == before
        assert one.DoStep(0.03, 1e-3) == fmi2Error
        rewind(one, state)
        assert one.serialize(saved(one)) == content
    assert_same(first, one.advance(AFTER))
    status, other = one.DeSerializeFMUstate(content[:-1])
    assert status == fmi2Error and one.Reset() == fmi2OK
    assert_same(first, one.initialize(KICK).advance([*BEFORE, *AFTER], at=[BEFORE[-1], *AFTER]))


# ---- Forgery ----


def sealed(content):
    """With a checksum that fits."""
    body = content[:-CHECKSUM]
    return body + struct.pack("<I", zlib.crc32(body))


def test_the_checksum_is_the_crc_32_of_zip_files(running):
    content = running().serialize(saved(running()))
    assert sealed(content) == content


def test_the_state_of_another_version_is_refused_and_says_so(running):
    one = running()
    content = bytearray(one.serialize(saved(one)))
    own = content[VERSION]
    for version in {0, own - 1, own + 1, 255}:
        content[VERSION] = version
        status, state = one.DeSerializeFMUstate(sealed(bytes(content)))
        assert status == fmi2Error and not state.value
        assert f"has version {version}, but this FMU reads version {own}" in one.reason


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1.0, 1e300, 5e-324])
def test_a_forged_number_is_refused_with_a_reason_or_runs(running, value):
    """Put at every place, where it makes of lengths, counts and states what it will."""
    one = running("set1")
    state = saved(one)
    content = one.serialize(state)
    refused, ran = 0, 0
    for place in range(CONTENT, len(content) - CHECKSUM - 7):
        forged = content[:place] + struct.pack("<d", value) + content[place + 8 :]
        assert one.SetFMUstate(state) == fmi2OK
        told = len(one.messages)
        status, other = one.DeSerializeFMUstate(sealed(forged))
        if status == fmi2OK:
            status = one.SetFMUstate(other)
            one.free_state(other)
        time = fmi2Real()
        if status == fmi2OK:
            assert one.call("GetRealStatus", fmi2LastSuccessfulTime, byref(time)) == fmi2OK
            status = one.DoStep(time.value, 5e-5)
            ran += status == fmi2OK
        refused += status == fmi2Error
        assert len(one.messages) == told + (status == fmi2Error)
        assert "internal error" not in one.reason
    print(f"{value} at {refused + ran} places: {refused} refused, {ran} run")
    assert refused > 50
    assert one.SetFMUstate(state) == fmi2OK


# ---- Phases ----


def new(one):
    return one


def initializing(one):
    assert one.SetupExperiment(stop=1.0) == one.Set(KICK) == one.EnterInitializationMode() == fmi2OK


def stepping(one):
    initializing(one)
    assert one.ExitInitializationMode() == fmi2OK
    one.advance(BEFORE)


def over(one):
    stepping(one)
    assert one.Terminate() == fmi2OK


def failed(one):
    stepping(one)
    assert one.DoStep(0.5, 1e-3) == fmi2Error


@pytest.mark.parametrize("phase", [new, initializing, stepping, over, failed])
def test_a_state_of_each_phase_comes_back_in_it(instance, phase, assert_same):
    one = instance("set2")
    phase(one)
    status, state = one.GetFMUstate()
    if status == fmi2Error:
        assert phase is failed and "fmi2GetFMUstate" in one.reason
        return
    other = instance("set2", name="other").initialize()
    status, read = other.DeSerializeFMUstate(one.serialize(state))
    assert status == fmi2OK and other.SetFMUstate(read) == fmi2OK, other.reason
    if phase in (new, initializing):
        for each in (one, other):
            if phase is new:
                initializing(each)
            assert each.ExitInitializationMode() == fmi2OK
            each.time = 0.0
    assert one.read(one.fmu.outputs) == other.read(one.fmu.outputs)
    steps = [each.DoStep(0.03 if phase is stepping else 0.0, 1e-3) for each in (one, other)]
    assert steps == ([fmi2Error] * 2 if phase in (over, failed) else [fmi2OK] * 2)
    assert one.read(one.fmu.outputs) == other.read(one.fmu.outputs)


def test_the_state_of_another_scene_is_refused(running, instance):
    one = running("set1")
    other = instance("set2").initialize()
    status, state = other.DeSerializeFMUstate(one.serialize(saved(one)))
    assert status == fmi2Error and not state.value
    assert "another FMU" in other.reason


def test_a_state_brings_along_whether_it_was_strict(instance):
    one, other = instance("set1"), instance("set1", name="other")
    strict = one.fmu.variables["strict"].valueReference
    one.slave.setBoolean([strict], [True])
    content = one.serialize(saved(one))
    assert content != other.serialize(saved(other))
    status, state = other.DeSerializeFMUstate(content)
    assert status == fmi2OK and other.SetFMUstate(state) == fmi2OK
    # As is reading before initialization.
    assert other.EnterInitializationMode() == fmi2Error
    assert other.slave.getBoolean([strict]) == [True]
    assert other.Reset() == fmi2OK
    other.initialize()
    assert other.slave.getBoolean([strict]) == [False]


def test_a_state_in_memory_is_that_of_its_own_fmu(instance):
    """set2 has the parts of set1: given to it, its state made one of the other."""
    one, other = instance("set1").initialize(), instance("set2").initialize()
    status, state = other.GetFMUstate()
    assert status == fmi2OK
    assert one.SetFMUstate(state) == fmi2Error and "another FMU" in one.reason
    assert one.Reset() == fmi2OK
    assert one.call("SerializedFMUstateSize", state, byref(c_size_t())) == fmi2Error
    other.free_state(state)


def test_null_is_no_state(running):
    one = running()
    assert one.SetFMUstate(fmi2FMUstate()) == fmi2Error
    assert "NULL" in one.reason
    one.free_state(fmi2FMUstate())
