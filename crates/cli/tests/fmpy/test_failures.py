"""A step that fails says when, where and why; the instance comes back, and no other one is touched.

Scenes that fail are made here, as none that is shipped does.
"""

import re
from ctypes import byref
from pathlib import Path

import fmpy
import pytest
from conftest import INTEGRATOR
from fmpy.fmi2 import fmi2Error, fmi2LastSuccessfulTime, fmi2OK, fmi2Real, fmi2Warning

event_driven = pytest.mark.skipif(INTEGRATOR != "event-driven", reason="of exact motion alone")

# A pad on a block that is far lighter and may go along the horizontal only. The contact leans by 0.1 rad: where the
# block slides under the pad, N (2 − 10 µ) N/kg is what N makes of their approach (Painlevé), up to µ = 0.2.
WEDGED = """
[friction]
coefficient = 0.1
[[mass]]
name = "pad"
mass = 1.0
force = [0.0, -10.0]
[[mass]]
name = "block"
mass = 0.01
locked = ["y"]
[[spring]]
name = "pad_x"
between = ["pad", "ground"]
direction = "x"
stiffness = 1e4
[[spring]]
name = "pad_y"
between = ["pad", "ground"]
direction = "y"
stiffness = 1e4
[[spring]]
name = "block_x"
between = ["block", "ground"]
direction = "x"
stiffness = 1e4
[[contact]]
name = "joint"
mass = "pad"
on = "block"
angle = 0.1
velocity = 0.1
[integrator]
step = 1e-5
"""

# Set 1 flutters; where contacts can neither open nor stick, nothing bounds it.
FLUTTER = (Path(__file__).parents[4] / "scenes" / "set1.toml").read_text() + """
[effects]
sticking = false
detachment = false
"""


@pytest.fixture
def exported(amontons, fmu_in, tmp_path):
    """The FMU of a scene that is written here."""

    def export(text, name="scene"):
        scene, fmu = tmp_path / f"{name}.toml", tmp_path / f"{name}.fmu"
        scene.write_text(text)
        amontons("export", scene, "-o", fmu)
        return fmu_in(fmpy.extract(str(fmu), tmp_path / name))

    return export


def fails(one, size, where, why, until=200):
    """Steps until a step fails; asserts that it says when, where and why."""
    for _ in range(until):
        start = one.time
        status = one.DoStep(start, size)
        if status != fmi2OK:
            break
        one.time = start + size
    assert status == fmi2Error, "it goes on"
    message = one.messages[-1]
    assert message.category == "logStatusError"
    times = re.match(r"between (\S+) s and (\S+) s ", message.text)
    assert times and float(times[1]) == start, message.text
    assert float(times[2]) == start + size, message.text
    assert f"the state is valid up to t = {times[1]} s" in message.text
    assert where in message.text and why in message.text, message.text
    # Nothing goes on from here but by the ways out.
    assert one.DoStep(start, size) == fmi2Error
    return start, message.text


def comes_back(make, break_it, times, assert_same):
    """What `break_it` does to an instance ends with Reset, and with a state from before it."""
    expected = make("expected").advance(times)
    one, other = make("one"), make("other")
    early = one.GetFMUstate()
    assert early[0] == fmi2OK
    start = one.time
    break_it(one)
    # Another instance of the same library goes on as if nothing had happened.
    assert_same(expected, other.advance(times))
    assert one.SetFMUstate(early[1]) == fmi2OK, one.reason
    one.time = start
    assert_same(expected, one.advance(times))
    break_it(one)
    assert one.Reset() == fmi2OK
    assert_same(expected, make("one", one).advance(times))
    one.free_state(early[1])


def maker(instance, fmu, values=None):
    """Makes instances, or sets up one that was reset."""

    def make(name, one=None):
        one = instance(fmu, name=name) if one is None else one
        return one.initialize(values)

    return make


STEPS = [1e-3 * i for i in range(1, 31)]


@pytest.mark.parametrize("scene", ["set1", "ring12", "disc_brake"])
def test_an_input_beyond_all_bounds_is_named(instance, assert_same, scene):
    make = maker(instance, scene)
    force, where = {
        "set1": ("module[2].f3", "contact[2], module[2].x"),
        "ring12": ("module[7].f1", "contact[7], module[7].x1"),
        "disc_brake": ("mass.lower.fx", "contact.lower_lining, mass.lower.x"),
    }[scene]

    def break_it(one):
        assert one.Set({force: 1e308}) == fmi2OK, one.reason
        fails(one, 1e-3, where, f"{force} = 1e308 is too large")

    comes_back(make, break_it, STEPS, assert_same)


def test_a_mass_that_no_contact_touches_is_named_itself(exported, instance):
    far = """
[[mass]]
name = "far"
mass = 1.0
locked = ["x"]
[[spring]]
name = "alone"
between = ["far", "ground"]
direction = "y"
stiffness = 1e4
"""
    one = instance(exported(WEDGED + far)).initialize()
    assert one.Set({"mass.far.fy": 1e308}) == fmi2OK, one.reason
    fails(one, 1e-3, "the motion at mass.far.y left", "mass.far.fy = 1e308", until=2000)


def test_flutter_that_nothing_bounds_ends_in_an_error(exported, instance, assert_same):
    make = maker(instance, exported(FLUTTER), {"friction.coefficient": 3.0})
    reached = []

    def break_it(one):
        start, _ = fails(one, 0.1, "contact[1], module[1].x1,", "flutter that grows without bound", 10_000)
        reached.append(start)

    comes_back(make, break_it, STEPS, assert_same)
    # It grows by 300 powers of ten, from 0 s on and from where the steps end.
    assert reached[0] > 1.0 and abs(reached[1] - reached[0]) < 0.2


def test_a_contact_that_friction_wedges_is_named(exported, instance, assert_same):
    """Where µ is raised in the run: at the start there would be no equilibrium."""
    make = maker(instance, exported(WEDGED))

    def break_it(one):
        assert one.Set({"friction.coefficient": 0.5}) == fmi2OK
        status = one.GetReal([one.fmu.variables["contact.joint.normal_force"].valueReference])[0]
        assert status == fmi2Error
        assert one.reason.startswith(f"at {one.time:g} s friction wedges contact.joint: ")
        assert one.reason.endswith("lower friction.coefficient")

    comes_back(make, break_it, STEPS, assert_same)


@event_driven
def test_more_oscillations_than_a_step_can_follow_are_refused_in_time(instance):
    """A mass that is 10¹⁹ times too small would be followed for hours."""
    one = instance("set1").initialize({"module[1].m1": 1e-19, "damping.beta": 0.0})
    start = one.time
    assert one.DoStep(start, 1e-3) == fmi2Error
    assert "took more than 100000 power series; lower integrator.step" in one.reason


def test_a_failed_step_is_told_once_and_its_time_asked_for(instance):
    one = instance("set1").initialize()
    one.advance(STEPS[:5])
    told = len(one.messages)
    assert one.Set({"module[1].f1": 1e308}) == fmi2OK
    assert one.DoStep(STEPS[4], 1e-3) == fmi2Error
    assert len(one.messages) == told + 1
    time = fmi2Real()
    # FMI has it asked after steps alone, so that there is a warning with the answer.
    assert one.call("GetRealStatus", fmi2LastSuccessfulTime, byref(time)) == fmi2Warning
    assert time.value == STEPS[4]
