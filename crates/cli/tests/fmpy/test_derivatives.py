"""Derivatives for coupling: by inputs against differences, by time against a run, and inputs that change over a
step against the scene's own signals."""

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import fmi2Error, fmi2Integer, fmi2OK, fmi2Real, fmi2ValueReference

FORCES = [f"contact[{i}].{kind}_force" for i in (1, 2) for kind in ("normal", "friction")]
KICK = {"initial.module[1].v1": 0.05}


def references(instance, names):
    variables = instance.fmu.variables
    return (fmi2ValueReference * len(names))(*(variables[name].valueReference for name in names))


def directional(instance, of, by):
    """Status and the changes of outputs."""
    found = (fmi2Real * len(of))(*[np.nan] * len(of))
    status = instance.call(
        "GetDirectionalDerivative",
        references(instance, of),
        len(of),
        references(instance, list(by)),
        len(by),
        (fmi2Real * len(by))(*by.values()),
        found,
    )
    return status, np.array(found)


def set_rates(instance, rates, order=1):
    orders = (fmi2Integer * len(rates))(*[order] * len(rates))
    values = (fmi2Real * len(rates))(*rates.values())
    return instance.call(
        "SetRealInputDerivatives", references(instance, list(rates)), len(rates), orders, values
    )


def output_rates(instance, of, order=1):
    found = (fmi2Real * len(of))(*[np.nan] * len(of))
    orders = (fmi2Integer * len(of))(*[order] * len(of))
    status = instance.call(
        "GetRealOutputDerivatives", references(instance, of), len(of), orders, found
    )
    return status, np.array(found)


def forces(instance):
    return np.array(instance.read(FORCES))


@pytest.mark.parametrize("name", ["module[1].f3", "module[2].f4", "module[1].f1", "friction.coefficient"])
def test_contact_forces_change_with_an_input_as_differences_say(instance, name):
    one = instance("set1").initialize(KICK)
    assert one.DoStep(0.0, 0.02) == fmi2OK
    value, h = one.read([name])[0], 1e-3
    status, found = directional(one, FORCES, {name: 2.0})
    assert status == fmi2OK
    ends = []
    for moved in (value - h, value + h):
        assert one.Set({name: moved}) == fmi2OK
        ends.append(forces(one))
    np.testing.assert_allclose(found, (ends[1] - ends[0]) / h, rtol=1e-7, atol=1e-8)
    # Contacts that slide feel what presses them on and friction, and nothing along the slider or behind a spring.
    assert np.any(found != 0.0) == (name in ("module[2].f4", "friction.coefficient"))


def test_before_the_run_starts_the_equilibrium_moves_as_well(instance):
    one, h = instance("set1"), 1e-4
    assert one.SetupExperiment() == fmi2OK
    assert one.EnterInitializationMode() == fmi2OK
    value = one.read(["friction.coefficient"])[0]
    status, found = directional(one, FORCES, {"friction.coefficient": 1.0})
    assert status == fmi2OK
    ends = []
    for moved in (value - h, value + h):
        assert one.Set({"friction.coefficient": moved}) == fmi2OK
        ends.append(forces(one))
    np.testing.assert_allclose(found, (ends[1] - ends[0]) / (2 * h), rtol=1e-6)
    # Friction at a fixed N would be N alone; it lifts the contact as well.
    assert found[0] != 0.0


def test_velocities_are_the_rates_of_displacements_and_forces_follow_the_motion(instance):
    one = instance("set1").initialize(KICK)
    h = 1e-5
    assert one.DoStep(0.0, 0.02) == fmi2OK
    before = forces(one)
    assert one.DoStep(0.02, h) == fmi2OK
    status, rates = output_rates(one, ["module[1].x1", *FORCES])
    assert status == fmi2OK
    assert rates[0] == one.read(["module[1].v1"])[0]
    assert one.DoStep(0.02 + h, h) == fmi2OK
    # Up to the order of the scheme where it is that; the modes are below 1 kHz.
    np.testing.assert_allclose(rates[1:], (forces(one) - before) / (2 * h), rtol=0.05, atol=1.0)


def test_inputs_that_are_given_with_their_rates_do_what_a_signal_does(
    instance, unpacked, fmu_in, amontons, tmp_path
):
    rate, step, count = 40.0, 1e-3, 20
    source = (unpacked("set1").folder / "resources" / "scene.toml").read_text()
    scene = tmp_path / "driven.toml"
    signal = f'input = "module[1].f1"\nramp = {{ to = {rate * step * count}, end = {step * count} }}'
    scene.write_text(f"{source}\n[[signal]]\n{signal}\n")
    driven = tmp_path / "driven.fmu"
    amontons("export", scene, "-o", driven)
    runs = []
    driven = fmu_in(fmpy.extract(str(driven), tmp_path / "driven"))
    for fmu, given in (("set1", True), (driven, False), ("set1", False)):
        one = instance(fmu).initialize()
        for i in range(count):
            if given:
                assert set_rates(one, {"module[1].f1": rate}) == fmi2OK
            assert one.DoStep(i * step, step) == fmi2OK
        runs.append(np.array(one.read(["module[1].x1", "module[1].v1", *FORCES])))
    np.testing.assert_allclose(runs[0], runs[1], rtol=1e-6)
    assert np.all(np.abs(runs[0] - runs[2]) > 1e-4 * np.abs(runs[0]))


def test_a_rate_holds_for_one_step_and_its_input_then_stays_where_it_is(instance):
    one = instance("set1").initialize()
    assert set_rates(one, {"module[1].f1": 100.0}) == fmi2OK
    assert one.DoStep(0.0, 0.01) == fmi2OK
    reached = one.read(["module[1].f1"])[0]
    assert reached == pytest.approx(1.0, rel=1e-12)
    assert one.DoStep(0.01, 0.01) == fmi2OK
    assert one.read(["module[1].f1"])[0] == reached


def test_rates_that_were_set_before_the_run_and_those_of_a_saved_state_are_kept(instance):
    runs = []
    for saved in (False, True):
        one = instance("set1")
        assert one.SetupExperiment() == fmi2OK
        assert one.EnterInitializationMode() == fmi2OK
        assert set_rates(one, {"module[1].f1": 100.0}) == fmi2OK
        if saved:
            status, state = one.GetFMUstate()
            content = one.serialize(state)
            one.free_state(state)
            assert status == fmi2OK and one.Reset() == fmi2OK
            status, state = one.DeSerializeFMUstate(content)
            assert status == fmi2OK and one.SetFMUstate(state) == fmi2OK
            one.free_state(state)
        assert one.ExitInitializationMode() == fmi2OK
        assert one.DoStep(0.0, 0.01) == fmi2OK
        runs.append(one.read(one.fmu.outputs))
    assert runs[0] == runs[1]
    other = instance("set1").initialize()
    assert other.DoStep(0.0, 0.01) == fmi2OK
    assert other.read(other.fmu.outputs) != runs[0]


@pytest.mark.parametrize(
    ("call", "part"),
    [
        (lambda one: directional(one, ["module[1].m1"], {"module[1].f1": 1.0})[0], "not an output"),
        (lambda one: directional(one, FORCES, {"module[1].m1": 1.0})[0], "not an input"),
        (lambda one: directional(one, FORCES, {"contact[1].state": 1.0})[0], "Real"),
        (lambda one: output_rates(one, FORCES, order=2)[0], "order 2"),
        (lambda one: output_rates(one, ["slider.velocity"])[0], "not an output"),
        (lambda one: set_rates(one, {"slider.velocity": 1.0}, order=2), "order 2"),
        (lambda one: set_rates(one, {"slider.velocity": np.nan}), "finite"),
        (lambda one: set_rates(one, {"module[1].m1": 1.0}), "not an input"),
        (lambda one: set_rates(one, {"module[1].x1": 1.0}), "not an input"),
    ],
)
def test_what_has_no_derivative_is_refused_with_the_reason(instance, call, part):
    one = instance("set1").initialize()
    assert call(one) == fmi2Error
    assert part in one.reason, one.reason
    # Nothing was taken over.
    assert one.Reset() == fmi2OK
    assert one.initialize().DoStep(0.0, 1e-3) == fmi2OK


def test_nothing_asked_is_nothing_answered(instance):
    one = instance("set1").initialize()
    assert directional(one, [], {})[0] == fmi2OK
    assert directional(one, FORCES, {})[1].tolist() == [0.0] * 4
    assert one.call("SetRealInputDerivatives", None, 0, None, None) == fmi2OK
    assert one.call("GetRealOutputDerivatives", None, 0, None, None) == fmi2OK
    assert one.call("GetRealOutputDerivatives", None, 1, None, None) == fmi2Error


WATCHED = """
[slider]
velocity = 0.1
angle = 0.0
[friction]
coefficient = 0.3
[effects]
stability = true
[[mass]]
name = "block"
mass = 1.0
force = [0.0, -10.0]
[[spring]]
name = "k"
between = ["block", "ground"]
direction = "x"
stiffness = 100.0
[[damper]]
name = "c"
between = ["block", "ground"]
direction = "x"
damping = 20.0
[[contact]]
name = "pad"
mass = "block"
[integrator]
step = 1e-4
"""


def test_stability_outputs_have_no_derivative(instance, fmu_in, amontons, tmp_path):
    scene = tmp_path / "watched.toml"
    scene.write_text(WATCHED)
    amontons("export", scene, "-o", tmp_path / "watched.fmu")
    one = instance(fmu_in(fmpy.extract(str(tmp_path / "watched.fmu"), tmp_path / "watched")))
    friction = {"friction.coefficient": 1.0}
    for name in ("stability.growth_rate", "stability.frequency"):
        for ask in (lambda: directional(one, [name], friction), lambda: output_rates(one, [name])):
            assert one.initialize().DoStep(0.0, 1e-3) == fmi2OK
            assert ask()[0] == fmi2Error
            assert name in one.reason and "discrete" in one.reason
            assert one.Reset() == fmi2OK
    assert one.initialize().DoStep(0.0, 1e-3) == fmi2OK
    status, found = directional(one, ["contact.pad.friction_force"], friction)
    assert status == fmi2OK and found[0] == pytest.approx(10.0, rel=1e-9)
