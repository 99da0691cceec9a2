"""Robustness and loudness: the numbers of the program, closed forms, and values that other tools draw."""

import csv
import json
import subprocess
import threading

import amontons
import numpy as np
import pytest
from test_stability import of_set1

MU = "friction.coefficient"


def results_of(programs, folder, *arguments):
    """The results of a study of the program: rows of results.csv, and study.json."""
    command = [programs / "amontons", "study", *arguments, "-o", folder]
    subprocess.run(command, check=True, capture_output=True)
    with open(folder / "results.csv", newline="") as lines:
        return list(csv.DictReader(lines)), json.loads((folder / "study.json").read_text())["results"]


def test_robustness_has_the_doubles_of_the_program(programs, tmp_path, set1):
    uncertain = {MU: "normal(1.2,0.1)", "module[*].k6": "normal(±5%)"}
    given = [f"--uncertain={name}={distribution}" for name, distribution in uncertain.items()]
    rows, _ = results_of(programs, tmp_path / "study", "robustness", "set1", "--points=256", "--seed=3", *given)
    found = set1.robustness(uncertain, points=256, seed=3)

    def read(prefix, place):
        return [float(found[f"{prefix}{part}"].values[place]) for part in ("value", "low", "high")]

    checked = 0
    for row in rows:
        expected = [float(row[part]) for part in ("value", "low", "high")]
        if row["quantity"] == "probability" and not row["from"]:
            place = found["probability"].values.tolist().index(row["of"])
            assert read("probability_", place) == expected
        elif row["quantity"] == "probability":
            [place] = np.flatnonzero(found["band_from"].values == float(row["from"]))
            assert read("band_", place) == expected
        else:
            kind, of = row["quantity"].split(" index of ")
            name = f"{'growth' if of == 'growth rate' else of}_{kind.removesuffix('-order')}"
            place = found["parameter"].values.tolist().index(row["of"])
            assert [float(found[f"{name}{part}"].values[place]) for part in ("", "_low", "_high")] == expected
        checked += 1
    assert checked == 3 + len(found["band_from"]) + 2 * 2 * 3
    assert found["nominal"].values.tolist() == [1.96, 250e3, 250e3] and found.attrs["draws"] == 4096
    assert found["class_draws"].values.sum() == 4096 and found.attrs["seed"] == 3


def test_the_interval_holds_the_part_of_a_uniform_coefficient_beyond_its_critical_value(set1):
    # The largest real part of the eigenvalues passes zero between these, by matrices that NumPy solves.
    low, high = 1.0, 1.5
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if of_set1(middle).real.max() > 0 else (middle, high)
    found = set1.robustness({MU: "uniform(1.0,1.5)"}, points=64, indices=False)
    expected = (1.5 - high) / 0.5
    place = found["probability"].values.tolist().index("unstable")
    assert found["probability_low"].values[place] <= expected <= found["probability_high"].values[place]
    assert np.isnan(found["growth_first"].values).all()


def test_runs_after_pushes_are_those_of_the_program_with_their_values(programs, tmp_path, held):
    scene = tmp_path / "held.toml"
    scene.write_text(held.text)
    options = ["--runs=6", "--points=16", "--longest=60", "--window=10"]
    study = tmp_path / "study"
    uncertain = f"--uncertain={MU}=uniform(±10%)"
    results_of(programs, study, "robustness", scene, uncertain, "--pushes=uniform(0,0.3)", *options)
    with open(study / "runs.csv", newline="") as lines:
        rows = list(csv.DictReader(lines))
    found = held.robustness(
        {MU: "uniform(±10%)"}, pushes="uniform(0,0.3)", runs=6, points=16, longest=60.0, window=10.0
    )
    assert [float(row["push"]) for row in rows] == found["run_push"].values.tolist()
    assert [row["end"].replace(" ", "-") for row in rows] == found["run_end"].values.tolist()
    assert [[float(row[MU])] for row in rows] == found["run_value"].values.tolist()
    assert {row["failure"] for row in rows} == {""}
    nominal = held[MU]
    assert (np.abs(found["run_value"].values / nominal - 1.0) < 0.1).all() and len(rows) == 6
    # From the equilibrium a damped block sticks only after a push that reaches the speed of the belt.
    squeals = found["run_push"].values > held["slider.velocity"]
    assert (found["run_end"].values == np.where(squeals, "squeals", "rests")).all() and squeals.any() and not squeals.all()
    place = found["probability"].values.tolist().index("squeals")
    assert found["probability_value"].values[place] == squeals.mean()


def test_pushes_need_no_parameter_that_scatters(held):
    found = held.robustness({}, pushes="uniform(0.01,0.05)", runs=2, longest=60.0, window=10.0)
    assert found["run_end"].values.tolist() == ["rests", "rests"] and found["run_value"].shape == (2, 0)
    assert found["probability"].values.tolist() == ["squeals"] and "nominal_growth" not in found.attrs


def test_what_is_cut_off_is_warned_of(set1):
    with pytest.warns(UserWarning, match="cut off where values become impossible"):
        set1.robustness({MU: "normal(4,1)"}, points=16)


def test_growth_rates_are_those_of_the_matrices_on_any_number_of_threads(set1):
    values = np.linspace(0.0, 1.96, 200)
    found = set1.growth_rates([MU], values.reshape(-1, 1))
    assert found.dtype == float and found.shape == (200,)
    assert found == pytest.approx([of_set1(mu).real.max() for mu in values], abs=1e-9)
    alone = amontons._core.on_this_thread(lambda: set1.growth_rates([MU], values.reshape(-1, 1)))
    assert alone.tobytes() == found.tobytes()
    swept = amontons.sweep(set1, {MU: values})["growth_rate"].values
    assert swept.tobytes() == found.tobytes()


def test_each_column_is_a_parameter_and_rows_without_equilibrium_are_not_a_number(set1):
    names = ["module[2].k6", MU, "module[1].k6"]
    rows = [[2e5, 1.3, 3e5], [3e5, 1.1, 2e5]]
    expected = [set1.with_values(dict(zip(names, row))).eigenvalues().real.max() for row in rows]
    assert set1.growth_rates(names, rows).tolist() == expected
    stuck = set1.growth_rates(names, rows, state="St")
    assert stuck.tolist() == [set1.with_values(dict(zip(names, row))).eigenvalues("St").real.max() for row in rows]
    tilted = set1.with_values({"slider.angle": -0.5})
    with pytest.raises(amontons.EquilibriumError):
        tilted.with_values({MU: 3.9}).equilibrium()
    assert np.isnan(tilted.growth_rates([MU], [[0.3], [3.9]])).tolist() == [False, True]
    assert set1.growth_rates([MU], np.empty((0, 1))).shape == (0,)


def test_growth_rates_are_computed_without_the_lock_of_the_interpreter(set1):
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    set1.growth_rates([MU], np.linspace(0.0, 1.9, 20_000).reshape(-1, 1))
    during = counted[0] - before
    over.set()
    thread.join()
    # With the lock held the other thread would not have counted at all.
    assert during > 10_000


def test_rows_that_are_impossible_are_told_with_number_and_values(set1):
    with pytest.raises(amontons.SceneError, match=r"row 2 is impossible: .*row 2 has friction.coefficient = -0.5"):
        set1.growth_rates([MU], [[1.0], [-0.5]])
    with pytest.raises(amontons.Error, match=r"row 1 cannot be analysed: no surface moves.*row 1 has slider.velocity = 0.0"):
        set1.growth_rates(["slider.velocity"], [[0.0]])


def test_a_parameter_that_a_signal_drives_has_no_rows(held):
    signal = '[[signal]]\ninput = "friction.coefficient"\nconstant = { value = 0.1 }\n'
    driven = amontons.Scene.from_toml(f"{held.text}\n{signal}")
    with pytest.raises(amontons.ArgumentError, match="drives friction.coefficient"):
        driven.growth_rates([MU], [[0.3]], at=0.0)
    with pytest.warns(UserWarning, match="analysed at t = 0 s"):
        driven.growth_rates(["slider.velocity"], [[0.3]])


def test_loudness_has_the_doubles_of_the_program(programs, tmp_path, set1):
    rows, results = results_of(programs, tmp_path / "study", "loudness", "set1", f"--set={MU}=3")
    found = set1.with_values({MU: 3.0}).loudness()
    assert found["way"].values.tolist() == [row["way"] for row in rows] and len(rows) == 2
    for column, name in (("growth_rate", "growth_rate"), ("frequency", "mode_frequency"), ("push", "push")):
        assert [float(row[column]) for row in rows] == found[name].values.tolist()
    for rank in ("growth_rank", "loudness_rank"):
        assert [int(row[rank]) for row in rows] == found[rank].values.tolist()
    motions = found["motion"].values
    assert [int(row["motion"]) - 1 for row in rows] == motions.tolist()
    for place, row in enumerate(rows):
        motion = motions[place]
        ending = results["found"]["motions"][motion]["ending"]
        assert ending["frequency"] == found["motion_frequency"].values[motion]
        assert float(row["velocity_rms"]) == found["speed_rms"].values[motion].max()
        assert float(row["power_of_friction"]) == found["motion_power"].values[motion]
        assert row["nearest_mode"] == found["motion_nearest_mode"].values[motion]
    assert found["finding_text"].values.tolist() == results["found"]["findings"]
    # The rms of a velocity is below its peak, and no point moves along its normal faster than at all.
    assert (found["speed_rms"] < found["speed_peak"]).all() and (found["normal_peak"] <= found["speed_peak"]).all()


def test_the_points_of_loudness_can_be_named(set1):
    found = set1.loudness(points=["module[2].m1"])
    assert found["point"].values.tolist() == ["module[2].m1"] and np.isnan(found["normal_rms"].values).all()
    with pytest.raises(amontons.ArgumentError, match=r"set1 has no point module\[2\].m3; the points are"):
        set1.loudness(points=["module[2].m3"])
