"""Wrong use raises the documented exception, and never ends the interpreter."""

import math

import amontons
import numpy as np
import pytest
from amontons import ArgumentError, Error, FileError, SceneError, StepError

NAN, INF = math.nan, math.inf
MU = "friction.coefficient"


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ({MU: NAN}, SceneError),
        ({MU: INF}, SceneError),
        ({MU: -1.0}, SceneError),
        ({MU: "x"}, ValueError),
        ({MU: None}, TypeError),
        ({MU: 1j}, TypeError),
        ({"integrator.step": 0.0}, SceneError),
        ({"module[1].k1": -1.0}, SceneError),
        ({"module[1].x1": 1.0}, ArgumentError),
        ({"friction.coefficent": 1.0}, ArgumentError),
        ({1: 2.0}, ArgumentError),
    ],
)
def test_impossible_values_are_refused(set1, values, kind):
    with pytest.raises(kind):
        set1.with_values(values)
    assert set1.values == {}


def test_a_misspelt_name_is_answered_with_the_nearest_one(set1):
    for ask in (
        lambda: set1.with_values({"friction.coefficent": 1.0}),
        lambda: set1["friction.coefficent"],
        lambda: set1.start()["friction.coefficent"],
        lambda: set1.simulate(0.001, outputs=["friction.coefficent"]),
        lambda: set1.locus("friction.coefficent", [1.0, 2.0]),
        lambda: set1.limit_cycles("friction.coefficent", [1.0, 2.0]),
        lambda: amontons.sweep(set1, {"friction.coefficent": [1.0]}),
        lambda: set1.robustness({"friction.coefficent": "normal(±1%)"}),
        lambda: set1.growth_rates(["friction.coefficent"], [[1.0]]),
    ):
        with pytest.raises(ArgumentError, match="did you mean friction.coefficient"):
            ask()


MISUSES = {
    "scenes": [
        (lambda s: amontons.Scene.builtin("set3"), ArgumentError),
        (lambda s: amontons.Scene.builtin(3), TypeError),
        (lambda s: amontons.Scene.read("no such file"), FileError),
        (lambda s: amontons.Scene.read(3), TypeError),
        (lambda s: amontons.Scene.from_toml(""), SceneError),
        (lambda s: amontons.Scene.from_toml("\0"), SceneError),
        (lambda s: amontons.Scene(), TypeError),
        (lambda s: setattr(s, "name", "x"), AttributeError),
        (lambda s: s.with_integrator("euler"), ArgumentError),
        (lambda s: s.with_integrator(step=NAN), ArgumentError),
        (lambda s: s.with_integrator(step=-1.0), ArgumentError),
        (lambda s: s.with_integrator(preset="best"), ArgumentError),
        (lambda s: s.with_integrator(preset="design", step=1e-3), ArgumentError),
        (lambda s: s.draw("picture.gif"), FileError),
        (lambda s: s.export("no such folder/set1.fmu"), FileError),
        (lambda s: s.export("x.fmu", platforms=["amiga"]), ArgumentError),
        (lambda s: s.export("x.fmu", platforms="linux64"), TypeError),
        (lambda s: s.with_values({MU: 1.0}).export("x.fmu"), ArgumentError),
    ],
    "runs": [
        (lambda s: s.simulate(NAN), SceneError),
        (lambda s: s.simulate(INF), SceneError),
        (lambda s: s.simulate(0.0), SceneError),
        (lambda s: s.simulate(-1.0), SceneError),
        (lambda s: s.simulate("x"), TypeError),
        (lambda s: s.simulate(0.001, 0.0), SceneError),
        (lambda s: s.simulate(0.001, NAN), SceneError),
        (lambda s: s.simulate(0.001, 1e-300), SceneError),
        (lambda s: s.simulate(1e300, 1e-300), SceneError),
        (lambda s: s.simulate(0.001, outputs="module[1].x1"), TypeError),
        (lambda s: s.simulate(0.001, outputs=["module[1].x9"]), ArgumentError),
        (lambda s: s.with_integrator(step=1e300).simulate(0.1), StepError),
        (lambda s: s.with_integrator(step=1e-300).simulate(0.1), SceneError),
        (lambda s: s.with_values({"initial.module[1].x1": 1e308}).simulate(0.001), StepError),
    ],
    "stability": [
        (lambda s: s.eigenvalues("X"), ArgumentError),
        (lambda s: s.eigenvalues(""), ArgumentError),
        (lambda s: s.eigenvalues("St-St-St"), ArgumentError),
        (lambda s: s.eigenvalues(friction=NAN), SceneError),
        (lambda s: s.eigenvalues(friction=-1.0), SceneError),
        (lambda s: s.eigenvalues(friction=1e300), amontons.AnalysisError),
        (lambda s: s.locus("friction.coefficient", [1.0]), amontons.AnalysisError),
        (lambda s: s.locus("friction.coefficient", []), ArgumentError),
        (lambda s: s.locus("friction.coefficient", [2.0, 1.0]), ArgumentError),
        (lambda s: s.locus("friction.coefficient", [1.0, NAN]), ArgumentError),
        (lambda s: s.locus("friction.coefficient", [[1.0, 2.0]]), ArgumentError),
        (lambda s: s.locus("friction.coefficient", ["a", "b"]), ValueError),
        (lambda s: s.locus("module[1].x1", [1.0, 2.0]), ArgumentError),
        (lambda s: s.growth_rates(MU, [[1.0]]), TypeError),
        (lambda s: s.growth_rates([MU], [1.0]), ArgumentError),
        (lambda s: s.growth_rates([MU], [["a"]]), ArgumentError),
        (lambda s: s.growth_rates([MU], [[1.0, 2.0]]), ArgumentError),
        (lambda s: s.growth_rates([], [[]]), ArgumentError),
        (lambda s: s.growth_rates([MU, MU], [[1.0, 2.0]]), ArgumentError),
        (lambda s: s.growth_rates(["module[*].k6"], [[1.0]]), ArgumentError),
        (lambda s: s.growth_rates([MU], [[NAN]]), SceneError),
        (lambda s: s.growth_rates([MU], [[1.0]], state="X"), ArgumentError),
        (lambda s: s.growth_rates([MU], [[1.0]], at=INF), ArgumentError),
        (lambda s: s.candidates(1.0, NAN), ArgumentError),
        # This range once took all memory.
        (lambda s: s.candidates(1.0, INF), ArgumentError),
        (lambda s: s.candidates(2.0, 1.0), ArgumentError),
        (lambda s: s.candidates(-1.0, 1.0), ArgumentError),
    ],
    "simulations": [
        (lambda s: s.start(NAN), ArgumentError),
        (lambda s: s.start("x"), ValueError),
        (lambda s: s.start().advance_to(NAN), StepError),
        (lambda s: s.start().advance_to(INF), StepError),
        (lambda s: s.start().advance_to(-1.0), StepError),
        (lambda s: s.start().advance_by(-1e-3), StepError),
        (lambda s: s.start()["x9"], ArgumentError),
        (lambda s: s.start()[3], TypeError),
        (lambda s: s.start().read("module[1].x1"), TypeError),
        (lambda s: s.start().read(["x9"]), ArgumentError),
        (lambda s: s.start().__setitem__(MU, NAN), ArgumentError),
        (lambda s: s.start().__setitem__(MU, -1.0), ArgumentError),
        (lambda s: s.start().__setitem__("module[1].x1", 1.0), ArgumentError),
        (lambda s: s.start().__setitem__("module[1].m1", 1.0), ArgumentError),
    ],
    "sweeps": [
        (lambda s: amontons.sweep(s, {}), ArgumentError),
        (lambda s: amontons.sweep(s, {MU: []}), ArgumentError),
        (lambda s: amontons.sweep(s, {MU: [NAN]}), ArgumentError),
        (lambda s: amontons.sweep(s, {MU: [2.0, 1.0]}), ArgumentError),
        (lambda s: amontons.sweep(s, {MU: [1.0, 1.0]}), ArgumentError),
        (lambda s: amontons.sweep(s, {MU: [[1.0]]}), ArgumentError),
        (lambda s: amontons.sweep(s, {"module[1].x1": [1.0]}), ArgumentError),
        (lambda s: amontons.sweep(s, {MU: [1.0]}, of="squeal"), ArgumentError),
        (lambda s: amontons.sweep(s, {MU: [1.0]}, of=3), ArgumentError),
        (lambda s: amontons.sweep(s, {MU: [1.0]}, executor=3), TypeError),
        (lambda s: amontons.sweep(s, {MU: [-2.0, -1.0]}), Error),
    ],
    "studies": [
        (lambda s: s.limit_cycles("slider.velocity", []), ArgumentError),
        (lambda s: s.limit_cycles("slider.velocity", [0.1], resolution=NAN), ArgumentError),
        (lambda s: s.limit_cycles("slider.velocity", [0.1], resolution=-1.0), ArgumentError),
        (lambda s: s.limit_cycles("slider.velocity", [0.1], of="x9"), ArgumentError),
        (lambda s: s.limit_cycles("slider.velocity", [0.1], window=NAN), ArgumentError),
        (lambda s: s.limit_cycles("slider.velocity", [0.1], window=1e300), ArgumentError),
        (lambda s: s.limit_cycles("slider.velocity", [0.1], longest=-1.0), ArgumentError),
        (lambda s: s.basin(("module[1].x1", [0, 1]), ("module[1].v1", [0, 1]), islands=3), ArgumentError),
        (lambda s: s.basin(("module[1].x1", [0, 1]), ("module[1].v1", [0, 1]), islands=-2), ArgumentError),
        (lambda s: s.perturbations("x9", [0.1]), ArgumentError),
        (lambda s: s.perturbations("module[1].v1", [0.2, 0.1]), ArgumentError),
        (lambda s: s.basin(("module[1].v1", [0.0]), ("module[1].v1", [0.0])), ArgumentError),
        (lambda s: s.basin(("x9", [0.0]), ("module[1].v1", [0.0])), ArgumentError),
        (lambda s: s.basin(3, 4), ArgumentError),
        (lambda s: s.continuation([1.0]), ArgumentError),
        (lambda s: s.continuation([1.0, 2.0], resolution=INF), ArgumentError),
        (lambda s: s.orbit("walk"), ArgumentError),
        (lambda s: s.orbit(("mode", 0)), ArgumentError),
        (lambda s: s.orbit(("mode", 99)), ArgumentError),
        (lambda s: s.orbit(("mode", 1.5)), ArgumentError),
        (lambda s: s.orbit(("between", "x9", 0.0, 1.0)), ArgumentError),
        (lambda s: s.orbit(("between", "module[1].v1", NAN, 1.0)), ArgumentError),
        (lambda s: s.orbit({"period": 3.0}), ArgumentError),
        (lambda s: s.orbit({"period": NAN}), ArgumentError),
        (lambda s: s.branches(MU, 1.0, 1.0), ArgumentError),
        (lambda s: s.branches(MU, NAN, 1.0), ArgumentError),
        (lambda s: s.branches(MU, 1.0, 2.0, points=-1), ArgumentError),
        (lambda s: s.robustness({}), ArgumentError),
        (lambda s: s.robustness([(MU, "normal(±1%)")]), ArgumentError),
        (lambda s: s.robustness({MU: "0.4"}), ArgumentError),
        (lambda s: s.robustness({MU: 0.4}), ArgumentError),
        (lambda s: s.robustness({"x9": "normal(±1%)"}), ArgumentError),
        (lambda s: s.robustness({"module[1].m1": "uniform(-1,1)"}), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, points=1000), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, points=16.5), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, scramblings=1), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, seed=-1), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, state="X"), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, bands=[(3.0, 1.0)]), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, bands=[(NAN, 1.0)]), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, window=1.0), ArgumentError),
        (lambda s: s.robustness({MU: "normal(±1%)"}, runs=7), ArgumentError),
        (lambda s: s.robustness({}, pushes="uniform(0,1)", state="Sl"), ArgumentError),
        (lambda s: s.robustness({}, pushes="uniform(0,1)", bands=[(0.0, 1.0)]), ArgumentError),
        (lambda s: s.robustness({}, pushes="uniform(0,1)", indices=False), ArgumentError),
        (lambda s: s.robustness({}, pushes="uniform(±1%)"), ArgumentError),
        (lambda s: s.robustness({}, pushes="uniform(-1,1)"), ArgumentError),
        (lambda s: s.robustness({}, pushes="uniform(0,1)", runs=0), ArgumentError),
        (lambda s: amontons.Scene.builtin("den_hartog").robustness({}, pushes="uniform(0,1)"), ArgumentError),
        (lambda s: s.loudness(push=-1.0), ArgumentError),
        (lambda s: s.loudness(points="module[1].m1"), TypeError),
        (lambda s: s.loudness(points=["x9"]), ArgumentError),
        (lambda s: s.loudness(candidates=-1), ArgumentError),
        (lambda s: s.loudness(of="x9"), ArgumentError),
        (lambda s: amontons.Scene.builtin("den_hartog").loudness(), ArgumentError),
        (lambda s: s.transient(-1.0), ArgumentError),
        (lambda s: s.transient(0.01, 0.0), ArgumentError),
        (lambda s: s.transient(0.01, of="x9"), ArgumentError),
    ],
}


@pytest.mark.parametrize("what", MISUSES)
def test_misuse_raises_the_documented_exception(set1, what, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for number, (misuse, kind) in enumerate(MISUSES[what]):
        with pytest.raises(kind) as raised:
            misuse(set1)
        assert str(raised.value) and "this is no study: expected" not in str(raised.value), number
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("misuse", "words"),
    [
        (lambda s: s.robustness({MU: "normal(±1%)"}, points="many"), "points = 'many' is impossible; give a power of two"),
        (lambda s: s.robustness({MU: "normal(±1%)"}, points=16.5), "points = 16.5 is impossible; give a power of two"),
        (lambda s: s.robustness({MU: "normal(±1%)"}, seed=None), "seed = None is impossible; give a whole number"),
        (lambda s: s.robustness({MU: "normal(±1%)"}, bands=[100.0]), "100.0 is no range of frequencies; a band is a pair"),
        (lambda s: s.robustness({MU: "normal(±1%)"}, bands=100.0), r"give pairs of frequencies in Hz"),
        (lambda s: s.robustness({MU: "normal(±1%)"}, bands=["ab"]), "'ab' is no range of frequencies; a band is a pair"),
        (lambda s: s.robustness({MU: "normal(±1%)"}, runs=7), "runs is for runs after pushes, and there are none"),
        (lambda s: s.robustness({}, pushes="uniform(0,1)", state="Sl"), "state is for eigenvalues of draws"),
        (lambda s: s.limit_cycles(MU, [1.0], window="long"), "window = 'long' is impossible; give a number"),
        (lambda s: s.growth_rates(["initial.module[1].v1"], [[1.0]]), "cannot have rows of values"),
        (lambda s: s.growth_rates(["module[1].x1"], [[1.0]]), "cannot be set: it is an output"),
    ],
)
def test_wrong_settings_are_answered_with_what_would_be_right(set1, misuse, words):
    with pytest.raises(ArgumentError, match=words):
        misuse(set1)


def test_states_that_are_none_are_refused_and_change_nothing(set1):
    simulation = set1.start()
    simulation.advance_to(0.001)
    state = simulation.save()
    for wrong in (b"", b"abc", b"\xff" * 1000, state[:-1], state[1:], state[: len(state) // 2]):
        with pytest.raises(Error, match="the saved state (is damaged|belongs)"):
            simulation.restore(wrong)
    for other in ("set2", "stick_slip"):
        with pytest.raises(Error, match="belongs to another scene"):
            simulation.restore(amontons.Scene.builtin(other).start().save())
    with pytest.raises(TypeError):
        simulation.restore("state")
    assert simulation.save() == state and simulation.time == 0.001


def test_damaged_states_never_end_the_interpreter(python):
    python(
        """
import random, signal
import amontons
scene = amontons.Scene.builtin("set1")
simulation = scene.start()
simulation.advance_to(0.0005)
state = simulation.save()
rng = random.Random(1)
taken = refused = 0
for _ in range(3000):
    wrong = bytearray(state)
    for _ in range(rng.choice([1, 1, 2, 8])):
        wrong[rng.randrange(len(wrong))] = rng.randrange(256)
    try:
        simulation.restore(bytes(wrong))
        taken += 1
        simulation.read(["module[1].x1", "contact[1].state"])
        simulation.advance_to(simulation.time + 2e-6)
    except amontons.Error:
        refused += 1
    simulation.restore(state)
assert taken and refused
assert simulation.save() == state
"""
    )


def test_bytes_behind_a_state_are_refused(set1):
    simulation = set1.start()
    with pytest.raises(Error):
        simulation.restore(simulation.save() + b"x")


def test_a_simulation_does_not_go_back_to_minus_infinity(set1):
    with pytest.raises(StepError):
        set1.start().advance_to(-INF)


@pytest.mark.parametrize("time", [INF, 1e300])
def test_a_time_that_is_refused_leaves_the_motion_as_it_was(set1, time):
    simulation = set1.start()
    simulation.advance_to(0.001)
    with pytest.raises(StepError):
        simulation.advance_to(time)
    assert simulation.time == 0.001


@pytest.mark.parametrize("at", [NAN, INF])
def test_an_instant_is_a_finite_time(set1, at):
    with pytest.raises(Error):
        set1.eigenvalues(at=at)


def test_times_that_are_refused_leave_the_motion_as_it_was(set1):
    simulation = set1.start()
    simulation.advance_to(0.001)
    state = simulation.save()
    for time in (NAN, 0.0005, -1.0):
        with pytest.raises(StepError):
            simulation.advance_to(time)
    simulation.advance_to(0.001)
    assert simulation.save() == state


def test_a_failed_step_loses_the_motion_until_a_state_is_restored(set1):
    simulation = set1.start()
    state = simulation.save()
    simulation["module[1].f1"] = 1e308
    with pytest.raises(StepError, match="left the range of floating-point numbers"):
        simulation.advance_by(1e-3)
    with pytest.raises(Error, match="restore a saved state"):
        simulation.time
    simulation.restore(state)
    simulation.advance_by(1e-3)
    assert np.isfinite(simulation.displacement).all()
