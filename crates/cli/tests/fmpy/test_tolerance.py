"""method = "auto": the FMU chooses method and step by the importer's tolerance, and nothing else does."""

import re
import subprocess

import fmpy
import numpy as np
import pytest
from conftest import Table, environment
from fmpy.fmi2 import fmi2Error, fmi2OK, fmi2Warning

STOP, INTERVAL = 0.02, 2e-4
KICK = {"initial.module[5].v1": 0.4}
TIMES = [INTERVAL * i for i in range(1, round(STOP / INTERVAL) + 1)]


def amontons(*arguments):
    """The program, without the integrator that other tests give it."""
    command = [environment("AMONTONS"), *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """Ring12 over 0.05 s with method = "auto": at 1e-2 it runs the paper's scheme, at 1e-4 exact motion."""
    text = amontons("scenes", "show", "ring12")
    text, steps = re.subn(r"(?m)^step = .*$", 'method = "auto"\ntolerance = 1e-2', text)
    text, stops = re.subn(r"(?m)^stop_time = .*$", "stop_time = 0.05", text)
    assert steps == stops == 1
    file = tmp_path_factory.mktemp("auto") / "auto.toml"
    file.write_text(text)
    return file


@pytest.fixture(scope="module")
def fmu(scene):
    file = scene.with_suffix(".fmu")
    amontons("export", scene, "-o", file)
    return file


@pytest.fixture
def auto(fmu, fmu_in, tmp_path):
    return fmu_in(fmpy.extract(str(fmu), tmp_path / "unpacked"))


@pytest.fixture
def native(scene, tmp_path):
    """A run of the program with a method and step, by default with what the scene's own tolerance chooses."""

    def simulate(*integrator):
        file = tmp_path / "native.csv"
        times = ["--stop-time", repr(STOP), "--output-interval", repr(INTERVAL)]
        values = [f"--set={name}={value!r}" for name, value in KICK.items()]
        amontons("simulate", scene, *times, *values, *integrator, "-o", file)
        names, *rows = (line.split(",") for line in file.read_text().splitlines())
        columns = [[float(row[i]) for row in rows] for i in range(len(names))]
        times, columns = columns[0], columns[1:]
        return Table(np.array(times), {n: np.array(c) for n, c in zip(names[1:], columns)})

    return simulate


def setup(one, tolerance=None):
    """fmi2SetupExperiment with a tolerance, or without."""
    return one.call("SetupExperiment", tolerance is not None, tolerance or 0.0, 0.0, False, 0.0)


def start(one, tolerance=None):
    assert setup(one, tolerance) == fmi2OK, one.reason
    assert one.Set(KICK) == fmi2OK
    assert one.EnterInitializationMode() == fmi2OK
    assert one.ExitInitializationMode() == fmi2OK, one.reason
    one.time = 0.0
    return one


def chosen(one):
    """Method and step that the instance told its logger last."""
    told = [m.text for m in one.messages if m.category == "logEvents" and m.text.startswith("chosen")]
    return re.match(r"chosen by the tolerance: ([a-z-]+), step (\S+) s", told[-1]).groups()


def options(one):
    method, step = chosen(one)
    return ["--integrator", method, "--step", step]


def test_the_default_experiment_has_the_tolerance_and_there_is_no_step_to_give(auto):
    assert auto.xml.find("DefaultExperiment").get("tolerance") == "0.01"
    assert "integrator.step" not in auto.variables


@pytest.mark.parametrize(
    ("tolerance", "method"), [(1e-2, "forward-increment"), (1e-4, "event-driven")]
)
def test_fmpy_gets_the_doubles_of_the_chosen_method_and_step(
    auto, instance, native, assert_same, tolerance, method
):
    told = start(instance(auto, logging_on=True), tolerance)
    assert chosen(told)[0] == method
    result = fmpy.simulate_fmu(
        str(auto.folder),
        stop_time=STOP,
        output_interval=INTERVAL,
        start_values=KICK,
        relative_tolerance=tolerance,
    )
    names = [name for name in result.dtype.names if name != "time"]
    imported = Table(result["time"], {name: result[name] for name in names})
    expected = native(*options(told))
    assert expected["statistics.state_changes"][-1] > 3
    assert_same(expected, imported)
    assert_same(expected, told.advance(TIMES)._replace(times=expected.times))


def test_without_a_tolerance_the_default_one_counts(auto, instance, native, assert_same):
    one = start(instance(auto, logging_on=True))
    assert chosen(one)[0] == "forward-increment"
    expected = native()
    assert_same(expected, one.advance(TIMES)._replace(times=expected.times))
    # Also where the experiment is not set up at all.
    other = instance(auto, logging_on=True)
    assert other.EnterInitializationMode() == fmi2Warning
    assert other.ExitInitializationMode() == fmi2OK
    assert chosen(other) == chosen(one)


def test_reset_goes_back_to_the_default_tolerance(auto, instance, assert_same):
    one = start(instance(auto, logging_on=True), 1e-4)
    one.advance(TIMES[:10])
    assert chosen(one)[0] == "event-driven"
    assert one.Reset() == fmi2OK
    start(one)
    assert chosen(one)[0] == "forward-increment"
    assert_same(start(instance(auto)).advance(TIMES), one.advance(TIMES))


def test_a_saved_state_brings_its_choice_along(auto, instance, assert_same):
    """Into an instance that chose otherwise, in memory and as bytes, before the start and after it."""
    coarse, fine = (start(instance(auto), tolerance) for tolerance in (1e-2, 1e-4))
    coarse.advance(TIMES[:50])
    status, state = coarse.GetFMUstate()
    assert status == fmi2OK
    content = coarse.serialize(state)
    expected = coarse.advance(TIMES[50:])
    status, restored = fine.DeSerializeFMUstate(content)
    assert status == fmi2OK and fine.SetFMUstate(restored) == fmi2OK, fine.reason
    fine.time = TIMES[49]
    assert_same(expected, fine.advance(TIMES[50:]))
    # Another tolerance is not looked at again: the choice was made.
    assert setup(fine, 1e-4) == fmi2Error

    early, late = instance(auto, logging_on=True), instance(auto, logging_on=True)
    assert setup(early, 1e-4) == setup(late, 1e-2) == fmi2OK
    status, waiting = early.GetFMUstate()
    assert status == fmi2OK
    content = early.serialize(waiting)
    status, moved = late.DeSerializeFMUstate(content)
    assert status == fmi2OK and late.SetFMUstate(moved) == fmi2OK
    assert late.EnterInitializationMode() == late.ExitInitializationMode() == fmi2OK
    assert chosen(late)[0] == "event-driven"
    for one, held in [(coarse, state), (fine, restored), (early, waiting), (late, moved)]:
        one.free_state(held)


@pytest.mark.parametrize("tolerance", [0.0, -1e-4, 1.0, float("nan"), float("inf")])
def test_a_tolerance_that_is_none_is_refused(auto, instance, tolerance):
    one = instance(auto)
    assert one.call("SetupExperiment", True, tolerance, 0.0, False, 0.0) == fmi2Error
    assert "tolerance = " in one.reason and "must be" in one.reason


def test_what_nothing_keeps_is_warned_of(auto, instance):
    one = start(instance(auto, logging_on=True), 1e-15)
    warnings = [m.text for m in one.messages if m.category == "logStatusWarning"]
    assert len(warnings) == 1 and "1e-15" in warnings[0], warnings


@pytest.mark.parametrize("tolerance", [1e-2, 1e-9, -1.0])
def test_a_scene_that_says_what_to_run_runs_it_whatever_is_passed(
    unpacked, instance, assert_same, tolerance
):
    one, other = instance("ring12"), instance("ring12")
    start(one)
    start(other, tolerance)
    assert_same(one.advance(TIMES[:20]), other.advance(TIMES[:20]))
