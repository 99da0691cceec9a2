"""Runs and simulations: the same doubles as the program, however a run is split, saved or sent elsewhere."""

import csv
import pickle
import subprocess
import threading

import amontons
import numpy as np
import pytest


@pytest.mark.parametrize("name", ["set1", "set2", "stick_slip", "corner"])
def test_a_run_has_the_doubles_of_the_program(programs, tmp_path, name):
    file = tmp_path / "run.csv"
    scene = amontons.Scene.builtin(name)
    step = scene["integrator.step"]
    stop, interval = 1000 * step, 10 * step
    subprocess.run(
        [programs / "amontons", "simulate", name, "--stop-time", repr(stop), "--output-interval", repr(interval)]
        + ["-o", file],
        check=True,
        capture_output=True,
    )
    with open(file, newline="") as lines:
        names, *rows = csv.reader(lines)
    run = scene.simulate(stop, interval)
    assert sorted(names) == sorted([*run.data_vars, "time"])
    assert len(rows) == 101
    for place, column in enumerate(names):
        assert [float(row[place]) for row in rows] == run[column].values.tolist(), column


def test_a_scene_file_runs_like_the_built_in_scene_of_its_text(tmp_path, set1):
    file = tmp_path / "set1.toml"
    file.write_text(set1.text)
    run, other = amontons.Scene.read(file).simulate(0.001), set1.simulate(0.001)
    assert run.equals(other)


def test_whole_numbers_and_units_are_kept(set1):
    run = set1.simulate(0.001, outputs=["contact[1].state", "module[1].v1"])
    assert run["contact[1].state"].dtype == np.int32
    assert run["module[1].v1"].attrs["units"] == "m/s" and run["time"].attrs["units"] == "s"
    assert run.attrs["integrator"] == "forward-increment" and run.attrs["step"] == 1e-6
    assert list(run.data_vars) == ["contact[1].state", "module[1].v1"]


def everything(simulation):
    names = [name for name, variable in simulation.scene.variables.items() if variable.causality == "output"]
    parts = [simulation.read(names), simulation.displacement, simulation.velocity]
    return simulation.time, *(part.tobytes() for part in parts), simulation.contact_states


@pytest.mark.parametrize("name", ["set1", "set2", "stick_slip"])
def test_split_saved_and_pickled_runs_continue_to_the_last_bit(name):
    scene = amontons.Scene.builtin(name)
    step = scene["integrator.step"]
    whole = scene.start()
    whole.advance_to(600 * step)
    split = scene.start()
    for _ in range(150):
        split.advance_by(2 * step)
    saved = split.save()
    elsewhere = pickle.loads(pickle.dumps(split))
    split.advance_to(600 * step)
    assert everything(split) == everything(whole)
    elsewhere.advance_to(600 * step)
    assert everything(elsewhere) == everything(whole)
    other = scene.start()
    other.advance_to(50 * step)
    other.restore(saved)
    assert other.time == pytest.approx(300 * step, rel=1e-12)
    other.advance_to(600 * step)
    assert everything(other) == everything(whole)
    assert len(saved) < 10_000


def test_a_run_continues_in_another_process(set1, python, tmp_path):
    simulation = set1.start()
    simulation["friction.coefficient"] = 1.5
    simulation.advance_to(0.001)
    (tmp_path / "simulation").write_bytes(pickle.dumps(simulation))
    simulation.advance_to(0.002)
    printed = python(
        "import pickle, pathlib\n"
        f"simulation = pickle.loads(pathlib.Path({str(tmp_path / 'simulation')!r}).read_bytes())\n"
        "simulation.advance_to(0.002)\n"
        "print(simulation['friction.coefficient'], simulation.displacement.tobytes().hex())\n"
    )
    assert printed.split() == ["1.5", simulation.displacement.tobytes().hex()]


def test_stepping_reads_what_a_run_records(set1):
    run = set1.simulate(0.002, 0.0005, outputs=["module[1].x1", "contact[1].normal_force"])
    simulation = set1.start()
    for place, time in enumerate(run["time"].values):
        simulation.advance_to(time)
        row = [run[name].values[place] for name in run.data_vars]
        assert simulation.read(run.data_vars).tolist() == row
        assert simulation["module[1].x1"] == row[0]
        motion = zip(set1.displacement_names, simulation.displacement, simulation.velocity)
        for name, displacement, velocity in motion:
            assert simulation[name] == displacement and simulation[name.replace(".x", ".v")] == velocity


def test_a_changed_parameter_acts_from_then_on_and_is_saved(set1):
    changed, same = set1.start(), set1.start()
    for simulation in (changed, same):
        simulation.advance_to(0.001)
    before = changed.displacement.tobytes()
    changed["friction.coefficient"] = 1.0
    assert changed.displacement.tobytes() == before and changed.scene["friction.coefficient"] == 1.96
    restored = set1.start()
    restored.restore(changed.save())
    assert restored["friction.coefficient"] == 1.0
    for simulation in (changed, same, restored):
        simulation.advance_to(0.002)
    assert changed.displacement.tobytes() != same.displacement.tobytes()
    assert everything(changed) == everything(restored)


def test_scenes_of_all_kinds_survive_a_pickle():
    for name in amontons.Scene.builtin_names():
        scene = amontons.Scene.builtin(name)
        scene = scene.with_values({"integrator.step": scene["integrator.step"] / 2})
        for scene in (scene, scene.with_integrator(preset="preview")):
            copy = pickle.loads(pickle.dumps(scene))
            assert copy == scene and copy.hash == scene.hash and repr(copy) == repr(scene)
            assert copy.eigenvalues("St").tobytes() == scene.eigenvalues("St").tobytes()


def test_a_scene_with_a_table_survives_a_pickle_without_its_folder(tmp_path):
    (tmp_path / "speed.csv").write_text("time,speed\n0,0.1\n1,0.2\n")
    scene_file = tmp_path / "driven.toml"
    signal = '[[signal]]\ninput = "slider.velocity"\ntable = { file = "speed.csv", column = "speed" }\n'
    scene_file.write_text(f'{amontons.Scene.builtin("stick_slip").text}\n{signal}')
    scene = amontons.Scene.read(scene_file)
    expected = scene.simulate(0.1)
    pickled = pickle.dumps(scene)
    for file in (scene_file, tmp_path / "speed.csv"):
        file.unlink()
    copy = pickle.loads(pickled)
    assert copy == scene and copy.simulate(0.1).equals(expected)
    assert scene != amontons.Scene.builtin("stick_slip")


@pytest.mark.parametrize(
    "kind", ["Error", "ArgumentError", "FileError", "SceneError", "EquilibriumError", "AnalysisError", "StepError"]
)
def test_exceptions_survive_a_pickle(kind):
    error = pickle.loads(pickle.dumps(getattr(amontons, kind)("why")))
    assert type(error) is getattr(amontons, kind) and str(error) == "why"
    assert isinstance(error, amontons.Error) and isinstance(error, ValueError)


def test_two_threads_cannot_use_one_simulation_at_once(set1):
    simulation = set1.with_integrator(step=1e-7).start()
    running = threading.Event()
    ended = []

    def advance():
        running.set()
        simulation.advance_to(0.05)
        ended.append(simulation.time)

    thread = threading.Thread(target=advance)
    thread.start()
    running.wait()
    errors = set()
    while thread.is_alive():
        for use in (lambda: simulation.time, simulation.save, lambda: simulation["module[1].x1"]):
            try:
                use()
            except amontons.Error as error:
                errors.add(str(error))
    thread.join()
    assert ended == [0.05]
    assert errors == {"this simulation is in use by another thread; give each thread a simulation of its own"}


def test_threads_with_simulations_of_their_own_get_the_same_doubles(set1):
    found = []

    def run():
        simulation = set1.start()
        simulation.advance_to(0.003)
        found.append(everything(simulation))

    threads = [threading.Thread(target=run) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 8 and all(one == found[0] for one in found)
